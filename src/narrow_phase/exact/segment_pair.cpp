#include "narrow_phase/exact/segment_pair.hpp"

#include <algorithm>

#include "narrow_phase/exact/orientation.hpp"

namespace octopair {

bool boxes_meet(const Segment3d& s, const Segment3d& t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [s_low, s_high] = std::minmax(s[0][axis], s[1][axis]);
        const auto [t_low, t_high] = std::minmax(t[0][axis], t[1][axis]);
        if (s_high < t_low || t_high < s_low) return false;
    }
    return true;
}

namespace {

/// Returns true if the segments meet, projected along `axis`: each segment has its ends on both sides of the other's line.
/// Requires: the segments lie in one plane, but not all ends on one line; so the four sides are not all 0.
bool coplanar_segments_meet(const Segment3d& s, const Segment3d& t, unsigned axis) {
    return line_side(s[0], s[1], t[0], axis) * line_side(s[0], s[1], t[1], axis) <= 0 &&
           line_side(t[0], t[1], s[0], axis) * line_side(t[0], t[1], s[1], axis) <= 0;
}

bool contains_coplanar(const Triangle3d& triangle, const Projection& projection, const Point3d& place) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (line_side(triangle[i], triangle[(i + 1) % 3], place, projection.axis) * projection.side < 0) return false;
    }
    return true;
}

bool coplanar_segment_meets(const Segment3d& segment, const Triangle3d& triangle, const Projection& projection) {
    if (contains_coplanar(triangle, projection, segment[0])) return true;
    for (std::size_t i = 0; i < 3; ++i) {
        if (segments_meet(segment, {triangle[i], triangle[(i + 1) % 3]})) return true;
    }
    return false;
}

}  // namespace

Projection projection_of(const Triangle3d& triangle) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        const int side = line_side(triangle[0], triangle[1], triangle[2], axis);
        if (side != 0) return {axis, side};
    }
    return {};
}

Segment3d hull_of_degenerate(const Triangle3d& triangle) {
    // Lexicographic order of the coordinates is the order along the line.
    const auto [low, high] = std::minmax_element(triangle.begin(), triangle.end());
    return {*low, *high};
}

unsigned projection_axis(const Segment3d& s, const Segment3d& t) {
    for (const auto& triple : {Triangle3d{s[0], s[1], t[0]}, Triangle3d{s[0], s[1], t[1]}, Triangle3d{s[0], t[0], t[1]},
                               Triangle3d{s[1], t[0], t[1]}}) {
        const unsigned axis = projection_of(triple).axis;
        if (axis < 3) return axis;
    }
    return 3;
}

bool segments_meet(const Segment3d& s, const Segment3d& t) {
    if (!boxes_meet(s, t)) return false;
    if (plane_side(s[0], s[1], t[0], t[1]) != 0) return false;
    const unsigned axis = projection_axis(s, t);
    return axis == 3 || coplanar_segments_meet(s, t, axis);
}

bool segment_meets_triangle(const Segment3d& segment, const Triangle3d& triangle) {
    const Projection projection = projection_of(triangle);
    if (projection.axis == 3) return segments_meet(segment, hull_of_degenerate(triangle));
    const auto& [a, b, c] = triangle;
    const int begin = plane_side(a, b, c, segment[0]);
    const int end = plane_side(a, b, c, segment[1]);
    if (begin * end > 0) return false;
    if (begin == 0 && end == 0) return coplanar_segment_meets(segment, triangle, projection);
    // The segment's line crosses the plane in one point. This point is outside the triangle only if the line passes two edges on different
    // sides.
    const int ab = plane_side(segment[0], segment[1], a, b);
    const int bc = plane_side(segment[0], segment[1], b, c);
    const int ca = plane_side(segment[0], segment[1], c, a);
    const bool any_left = ab > 0 || bc > 0 || ca > 0, any_right = ab < 0 || bc < 0 || ca < 0;
    return !(any_left && any_right);
}

}  // namespace octopair
