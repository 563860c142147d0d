// Oracle for the exact tests of triangles: computes the same results in rational numbers by different methods. Also
// makes the test triangles. The triangles have small integer corners and are often degenerate, coplanar, touching or
// adjacent. Some triangles are copied to all scales, and some lie almost in a common plane.
#pragma once

#include <array>
#include <random>
#include <string>

#include "octopair/filters.hpp"

namespace octopair::test {

/// Returns the sign of the determinant of b - a, c - a, d - a.
int oracle_plane_side(const std::array<Point3d, 4>& corners);

/// Returns whether two triangles intersect. Clips one triangle by the half spaces and planes whose intersection is the
/// other triangle.
bool oracle_meet(const Triangle3d& a, const Triangle3d& b);
/// Returns the number of places that are a corner of both triangles: 0 to 3.
unsigned oracle_shared_corners(const Triangle3d& a, const Triangle3d& b);
/// Returns whether the triangles intersect outside of the shared corner, edge or edges.
bool oracle_meet_beyond(const Triangle3d& a, const Triangle3d& b);
/// The intersection of two triangles.
struct OracleContact {
    std::size_t corners;  ///< number of distinct corners
    bool area;            ///< the intersection is more than a segment
    bool inside;          ///< the middle of the intersection is on no edge of either triangle
};
OracleContact oracle_contact(const Triangle3d& a, const Triangle3d& b);

using TrianglePair = std::array<Triangle3d, 2>;
/// `kind`: 0 to pair_kinds - 1.
inline constexpr unsigned pair_kinds = 8;
TrianglePair some_pair(unsigned kind, std::mt19937& random);

std::string text(const TrianglePair& pair);

}  // namespace octopair::test
