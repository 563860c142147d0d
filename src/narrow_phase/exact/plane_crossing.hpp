// Two triangles in different planes: where each meets the line that the planes have in common.
//
// A triangle whose corners are not all on one side of the other's plane meets that line in a segment, whose ends lie on
// the two edges of one corner: the one that is alone on its side. Turned so that these corners are first and, by swapping
// the other two, on the positive sides, the triangles' segments are ordered along the line by the sides of edges to edges:
// with x = normal of b x normal of a as the line's direction, the first triangle's edges cross it at first <= second, the
// second's at second <= first (edge 01 is `first`, 02 `second`), and
//
//     plane_side(ends of an edge of the first, ends of an edge of the second)
//
// is the sign of the first one's crossing less the second one's. (Guigue and Devillers, "Fast and robust triangle-triangle
// overlap test using orientation predicates", 2003, have the like.)
#pragma once

#include <utility>

#include "narrow_phase/exact/orientation.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// Of a triangle's corners to the other's plane.
using CornerSides = std::array<int, 3>;

inline CornerSides corner_sides(const PlaneSides& plane, const Triangle3d& triangle) {
    return {plane(triangle[0]), plane(triangle[1]), plane(triangle[2])};
}
inline bool on_one_side(const CornerSides& sides) { return sides[0] * sides[1] > 0 && sides[0] * sides[2] > 0; }
inline bool in_plane(const CornerSides& sides) { return sides[0] == 0 && sides[1] == 0 && sides[2] == 0; }

class PlaneCrossing {
public:
    /// Of sides that are neither on_one_side nor in_plane. The triangles must outlive it.
    PlaneCrossing(const Triangle3d& a, const CornerSides& a_sides, const Triangle3d& b, const CornerSides& b_sides)
        : a_(a), b_(b), a_turn_(turn(a_sides)), b_turn_(turn(b_sides)) {
        if (up(a_sides, a_turn_) < 0) std::swap(b_turn_[1], b_turn_[2]);
        if (up(b_sides, b_turn_) < 0) std::swap(a_turn_[1], a_turn_[2]);
    }

    /// The sign of where edge 0i of the first crosses, less where edge 0j of the second does.
    int order(unsigned i, unsigned j) const {
        return plane_side(a_[a_turn_[0]], a_[a_turn_[i]], b_[b_turn_[0]], b_[b_turn_[j]]);
    }
    bool meet() const { return order(1, 1) <= 0 && order(2, 2) >= 0; }

    using Turn = std::array<unsigned, 3>;
    /// Which corners are 0, 1 and 2.
    const Turn& first() const { return a_turn_; }
    const Turn& second() const { return b_turn_; }

private:
    /// Corner i is alone: all others are on the other side, or in the plane; or it is in the plane and no other is.
    static bool alone(const CornerSides& sides, unsigned i) {
        const int side = sides[i], next = sides[(i + 1) % 3], last = sides[(i + 2) % 3];
        return side != 0 ? side * next <= 0 && side * last <= 0 : next * last > 0;
    }
    static Turn turn(const CornerSides& sides) {
        if (alone(sides, 0)) return {0, 1, 2};
        if (alone(sides, 1)) return {1, 2, 0};
        return {2, 0, 1};
    }
    /// The side that the lone corner counts as.
    static int up(const CornerSides& sides, const Turn& turn) {
        return sides[turn[0]] != 0 ? sides[turn[0]] : -sides[turn[1]];
    }

    const Triangle3d &a_, &b_;
    Turn a_turn_, b_turn_;
};

}  // namespace octopair
