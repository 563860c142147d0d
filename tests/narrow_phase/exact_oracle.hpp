// What the exact tests of triangles are held against: the same answers from rational numbers, by other ways. And where
// both are tried: triangles with small integer corners, which are often degenerate, coplanar, touching or adjacent, the
// same at all scales, and such as lie almost in one plane.
#pragma once

#include <array>
#include <random>
#include <string>
#include <vector>

#include "octopair/filters.hpp"

namespace octopair::test {

/// Of the determinant of b - a, c - a, d - a.
int oracle_plane_side(const std::array<Point3d, 4>& corners);

/// One triangle's corners are cut by the half spaces and planes whose intersection the other one is: whether any are left.
bool oracle_meet(const Triangle3d& a, const Triangle3d& b);
/// Whether any of them are left outside of the shared corner, edge or edges.
bool oracle_meet_beyond(const Triangle3d& a, const Triangle3d& b);
/// What they have in common.
struct OracleContact {
    std::size_t corners;  ///< different ones
    bool area;            ///< it is more than a segment
    bool inside;          ///< its middle is inside of both: no point of their edges
};
OracleContact oracle_contact(const Triangle3d& a, const Triangle3d& b);

using TrianglePair = std::array<Triangle3d, 2>;
/// `kind`: 0 to pair_kinds - 1.
inline constexpr unsigned pair_kinds = 8;
TrianglePair some_pair(unsigned kind, std::mt19937& random);

std::string text(const TrianglePair& pair);

}  // namespace octopair::test
