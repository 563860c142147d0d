#include "narrow_phase/exact/ray_parity.hpp"

#include <algorithm>

#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/segment_pair.hpp"

namespace octopair {
namespace {

/// The two axes perpendicular to `axis`: in the projection of line_side(), u points to the right and v upward.
struct Across {
    unsigned axis, u, v;
    explicit Across(unsigned along) : axis(along), u(along == 2 ? 0 : along + 1), v(along == 0 ? 2 : along - 1) {}
};

int compare(double a, double b) { return int(a > b) - int(a < b); }

/// Returns line_side() of `place` after a move by e on v and by e^2 on u; 0 only if the edge is projected to a point. A place that moves
/// upward gets to the left of an edge that goes right. A place that moves right gets to the right of an edge that goes up.
int moved_line_side(const Point3d& begin, const Point3d& end, const Point3d& place, const Across& across) {
    const int side = line_side(begin, end, place, across.axis);
    if (side != 0) return side;
    const int right = compare(end[across.u], begin[across.u]);
    return right != 0 ? right : -compare(end[across.v], begin[across.v]);
}

}  // namespace

bool ray_crosses(const Point3d& from, const Triangle3d& triangle, unsigned axis) {
    const auto& [a, b, c] = triangle;
    if (std::max({a[axis], b[axis], c[axis]}) < from[axis]) return false;
    const Across across(axis);
    for (const unsigned side : {across.u, across.v}) {
        const auto [low, high] = std::minmax({a[side], b[side], c[side]});
        if (from[side] < low || high < from[side]) return false;
    }
    const int side = moved_line_side(a, b, from, across);
    if (side == 0 || moved_line_side(b, c, from, across) != side || moved_line_side(c, a, from, across) != side) {
        return false;
    }
    // If `side` is 1, the projected triangle is counterclockwise and its normal points along the axis. So the ray reaches the
    // plane only from the side opposite to the normal.
    return plane_side(a, b, c, from) * side < 0;
}

bool point_on_triangle(const Point3d& place, const Triangle3d& triangle) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
        if (place[axis] < low || high < place[axis]) return false;
    }
    return segment_meets_triangle({place, place}, triangle);
}

}  // namespace octopair
