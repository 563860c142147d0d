// PlaneCrossing: two triangles in different planes, and where each crosses the line that the planes have in common.
//
// Segment   A triangle whose corners are not all on one side of the other plane meets the line in a segment. The ends of the
//           segment lie on the two edges of the lone corner: the corner that is alone on its side.
// Order     The corners of each triangle are rotated so that the lone corner is corner 0. Corners 1 and 2 are swapped where
//           needed, so that the lone corners count as on the positive sides.
// Direction The line's direction is (normal of b) x (normal of a). Along it, edge 01 of a crosses before edge 02 of a, or at
//           the same place; edge 02 of b crosses before edge 01 of b, or at the same place.
// Sign      plane_side(ends of an edge of a, ends of an edge of b) is the sign of a's crossing minus b's crossing.
// Source    Similar to Guigue and Devillers, "Fast and robust triangle-triangle overlap test using orientation predicates",
//           2003.
#pragma once

#include <utility>

#include "narrow_phase/exact/orientation.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// Side of the other triangle's plane for each corner of a triangle: -1, 0 or 1.
using CornerSides = std::array<int, 3>;

inline CornerSides corner_sides(const PlaneSides& plane, const Triangle3d& triangle) {
    return {plane(triangle[0]), plane(triangle[1]), plane(triangle[2])};
}
inline bool on_one_side(const CornerSides& sides) { return sides[0] * sides[1] > 0 && sides[0] * sides[2] > 0; }
inline bool in_plane(const CornerSides& sides) { return sides[0] == 0 && sides[1] == 0 && sides[2] == 0; }

class PlaneCrossing {
public:
    /// Borrows the triangles: they must outlive this object.
    /// Requires: neither on_one_side() nor in_plane() holds for `a_sides` or `b_sides`.
    PlaneCrossing(const Triangle3d& a, const CornerSides& a_sides, const Triangle3d& b, const CornerSides& b_sides)
        : a_(a), b_(b), a_corners_(corner_order(a_sides)), b_corners_(corner_order(b_sides)) {
        if (up(a_sides, a_corners_) < 0) std::swap(b_corners_[1], b_corners_[2]);
        if (up(b_sides, b_corners_) < 0) std::swap(a_corners_[1], a_corners_[2]);
    }

    /// Returns the sign of the crossing of edge 0i of the first triangle minus that of edge 0j of the second.
    int order(unsigned i, unsigned j) const {
        return plane_side(a_[a_corners_[0]], a_[a_corners_[i]], b_[b_corners_[0]], b_[b_corners_[j]]);
    }
    bool meet() const { return order(1, 1) <= 0 && order(2, 2) >= 0; }

    /// Indices in the triangle of the corners 0, 1 and 2.
    using CornerOrder = std::array<unsigned, 3>;
    const CornerOrder& first() const { return a_corners_; }
    const CornerOrder& second() const { return b_corners_; }

private:
    /// Returns true if corner i is the lone corner. Either the others are on the other side or in the plane. Or corner i is in
    /// the plane and the others are on one side of it.
    static bool alone(const CornerSides& sides, unsigned i) {
        const int side = sides[i], next = sides[(i + 1) % 3], last = sides[(i + 2) % 3];
        return side != 0 ? side * next <= 0 && side * last <= 0 : next * last > 0;
    }
    static CornerOrder corner_order(const CornerSides& sides) {
        if (alone(sides, 0)) return {0, 1, 2};
        if (alone(sides, 1)) return {1, 2, 0};
        return {2, 0, 1};
    }
    /// Returns the side of the lone corner. If the lone corner is in the plane, returns the side opposite to that of corner 1.
    static int up(const CornerSides& sides, const CornerOrder& corners) {
        return sides[corners[0]] != 0 ? sides[corners[0]] : -sides[corners[1]];
    }

    const Triangle3d &a_, &b_;
    CornerOrder a_corners_, b_corners_;
};

// Where a segment crosses a plane or a line that has its two ends on different sides. The results are not exact, but right to a few
// roundings even if the angle is narrow. If float64 cannot determine the heights of the ends above the plane or line, exact integer
// arithmetic computes them.

/// Returns the crossing with the triangle's plane as a fraction of the segment, 0 at `begin` and 1 at `end`.
/// Requires: the ends are not on the same side; at most one of them lies in the plane.
double part_to_plane(const Triangle3d& triangle, const Point3d& begin, const Point3d& end);

/// The line through a and b, projected along `axis`, as in line_side().
struct ProjectedLine {
    const Point3d &a, &b;
    unsigned axis;
};
/// Returns the crossing with a projected line as a fraction of the projected segment, 0 at `begin` and 1 at `end`. Requires: as for
/// part_to_plane(), with the line in place of the plane.
double part_to_line(const ProjectedLine& line, const Point3d& begin, const Point3d& end);

}  // namespace octopair
