#include "narrow_phase/exact/segment_pair.hpp"

#include <algorithm>

#include "narrow_phase/exact/orientation.hpp"

namespace octopair {
namespace {

/// The closed boxes overlap. Of points that all lie on one line, this says that the segments meet.
bool boxes_meet(const Segment3d& s, const Segment3d& t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [s_low, s_high] = std::minmax(s[0][axis], s[1][axis]);
        const auto [t_low, t_high] = std::minmax(t[0][axis], t[1][axis]);
        if (s_high < t_low || t_high < s_low) return false;
    }
    return true;
}

/// In a plane that is seen along the axis. Each straddles the other's line, or they lie apart; that all four sides are 0
/// would take a common line.
bool coplanar_segments_meet(const Segment3d& s, const Segment3d& t, unsigned axis) {
    return line_side(s[0], s[1], t[0], axis) * line_side(s[0], s[1], t[1], axis) <= 0 &&
           line_side(t[0], t[1], s[0], axis) * line_side(t[0], t[1], s[1], axis) <= 0;
}

bool holds_coplanar(const Triangle3d& triangle, const Facing& facing, const Point3d& place) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (line_side(triangle[i], triangle[(i + 1) % 3], place, facing.axis) * facing.side < 0) return false;
    }
    return true;
}

bool coplanar_segment_meets(const Segment3d& segment, const Triangle3d& triangle, const Facing& facing) {
    if (holds_coplanar(triangle, facing, segment[0])) return true;
    for (std::size_t i = 0; i < 3; ++i) {
        if (segments_meet(segment, {triangle[i], triangle[(i + 1) % 3]})) return true;
    }
    return false;
}

}  // namespace

Facing facing(const Triangle3d& triangle) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        const int side = line_side(triangle[0], triangle[1], triangle[2], axis);
        if (side != 0) return {axis, side};
    }
    return {};
}

Segment3d hull_of_degenerate(const Triangle3d& triangle) {
    // Along a line, the order of the corners is that of their numbers.
    const auto [low, high] = std::minmax_element(triangle.begin(), triangle.end());
    return {*low, *high};
}

unsigned facing_axis(const Segment3d& s, const Segment3d& t) {
    for (const auto& triple : {Triangle3d{s[0], s[1], t[0]}, Triangle3d{s[0], s[1], t[1]}, Triangle3d{s[0], t[0], t[1]},
                               Triangle3d{s[1], t[0], t[1]}}) {
        const unsigned axis = facing(triple).axis;
        if (axis < 3) return axis;
    }
    return 3;
}

bool segments_meet(const Segment3d& s, const Segment3d& t) {
    if (!boxes_meet(s, t)) return false;
    if (plane_side(s[0], s[1], t[0], t[1]) != 0) return false;
    const unsigned axis = facing_axis(s, t);
    return axis == 3 || coplanar_segments_meet(s, t, axis);
}

bool segment_meets_triangle(const Segment3d& segment, const Triangle3d& triangle) {
    const Facing seen = facing(triangle);
    if (seen.axis == 3) return segments_meet(segment, hull_of_degenerate(triangle));
    const auto& [a, b, c] = triangle;
    const int begin = plane_side(a, b, c, segment[0]);
    const int end = plane_side(a, b, c, segment[1]);
    if (begin * end > 0) return false;
    if (begin == 0 && end == 0) return coplanar_segment_meets(segment, triangle, seen);
    // The line crosses the plane in one point; it is inside unless the line passes two edges on different sides.
    const int ab = plane_side(segment[0], segment[1], a, b);
    const int bc = plane_side(segment[0], segment[1], b, c);
    const int ca = plane_side(segment[0], segment[1], c, a);
    const bool any_left = ab > 0 || bc > 0 || ca > 0, any_right = ab < 0 || bc < 0 || ca < 0;
    return !(any_left && any_right);
}

}  // namespace octopair
