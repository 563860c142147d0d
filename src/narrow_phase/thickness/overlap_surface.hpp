// OverlapSurface: the surface of the overlap of two closed meshes, in pieces.
//
// Overlap   The points that lie in both closed solids. Its surface consists of parts of each mesh that lie in the other solid.
// Pieces    Convex polygons. A piece does not pass through the surface of the other solid: the planes of the triangles that meet its
//           triangle cut it. Pieces on the surface of the other solid count. Pieces that lie outside are left out.
// Places    Relative to `centre`, the middle of the common box of the meshes. So rounding is relative to the size of the overlap.
// Rounding  Planes closer than `rounding` count as one plane.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/thickness/polygon.hpp"

namespace octopair {

enum class Membership : std::uint8_t { unknown, inside, outside, meets };

/// A triangle of one mesh near the other mesh.
struct NearTriangle {
    Triangle3d corners;
    Box3d box;
    CutPlane plane;
    std::uint32_t place;  ///< in the tree's order
    std::uint32_t met_begin = 0,
                  met_end = 0;  ///< triangles of the other mesh that meet it: a range of OverlapSide::met
    Membership membership = Membership::unknown;  ///< in the other solid; `meets` if met_begin < met_end
};

struct OverlapSide {
    std::vector<NearTriangle> triangles;
    std::vector<std::uint32_t> met;  ///< indices into the triangles of the other side
};

struct Piece {
    Polygon polygon;
    Point3d normal;  ///< length 1; it may point inward
    double area;
    unsigned side;  ///< 0: a piece of a; 1: a piece of b
};

/// Triangles of both meshes that may have pieces in a box: indices into OverlapSide::triangles.
using NearLists = std::array<std::vector<std::uint32_t>, 2>;

struct FoundPieces {
    std::vector<Piece> pieces;
    NearLists near;  ///< triangles that have pieces in the box
};

class OverlapSurface {
public:
    /// Borrows the meshes. Requires: both meshes are closed. `reach`: how far around the common box triangles are near.
    OverlapSurface(const PosedMesh& a, const PosedMesh& b, double reach);

    /// Finds the triangles that may have pieces. Until then there are no pieces. Requires: rounding() is finite.
    void find_triangles();

    /// Common box of the meshes; empty if min > max on an axis.
    const Box3d& common_box() const { return common_; }
    double rounding() const { return rounding_; }
    NearLists all_near() const;

    /// Appends the pieces in `box` to `found`. Returns false if there are more than `most`; then the pieces are incomplete.
    bool find_pieces(const Box3d& box, const NearLists& near, std::size_t most, FoundPieces& found);

    /// Returns true if the point is inside both solids.
    bool in_both(const Point3d& point) const { return in_solid(0, point) && in_solid(1, point); }
    /// Returns true if the point is inside the solid of one side.
    bool in_solid(unsigned side, const Point3d& point) const { return encloses(*meshes_[side], world(point)); }
    Point3d world(const Point3d& point) const { return vector::plus(point, centre_); }

private:
    void find_near();
    void find_meetings();
    void add_pieces(unsigned side, const NearTriangle& triangle, const Polygon& polygon,
                    std::vector<Piece>& pieces) const;
    Membership membership(unsigned side, NearTriangle& triangle) const;

    std::array<const PosedMesh*, 2> meshes_;
    std::array<OverlapSide, 2> sides_;
    Point3d centre_ = {};
    Box3d common_ = {};  // relative to centre_
    double reach_, rounding_ = 0;
};

}  // namespace octopair
