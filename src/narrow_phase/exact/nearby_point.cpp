#include "narrow_phase/exact/nearby_point.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <tuple>

#include "geometry/exact_integer.hpp"
#include "narrow_phase/exact/orientation.hpp"

namespace octopair {
namespace {

using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>, boost::multiprecision::et_off>;
using IntegerPoint = std::array<Integer, 3>;

/// Returns the points as integers: multiples of the step of a common grid, relative to the first point.
template <std::size_t count>
std::array<IntegerPoint, count> integers_of(const std::array<const Point3d*, count>& points) {
    std::array<double, 3 * count> numbers;
    for (std::size_t i = 0; i < 3 * count; ++i) numbers[i] = (*points[i / 3])[i % 3];
    const DyadicGrid<3 * count> grid(numbers);
    std::array<IntegerPoint, count> out;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            out[i][axis] = grid.template at<Integer>(3 * i + axis) - grid.template at<Integer>(axis);
        }
    }
    return out;
}

/// Returns coordinate `axis` of (b - a) x (c - a).
Integer line_value(const IntegerPoint& a, const IntegerPoint& b, const IntegerPoint& c, unsigned axis) {
    const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
    return (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
}

/// Returns the sign that an affine function has at a crossing. The function has the values `begin` and `end` at the ends of the
/// segment Place::on. The crossing divides this segment in the ratio of the heights of its ends above Place::across.
int sign_between(const Integer& begin, const Integer& end, const Integer& height_begin, const Integer& height_end) {
    const Integer sum = abs(height_end) * begin + abs(height_begin) * end;
    return sum.sign();
}

int exact_plane_side(const Place& place, const Point3d& a, const Point3d& b, const Point3d& c) {
    const auto [ia, ib, ic, begin, end, from, to] =
        integers_of<7>({&a, &b, &c, place.on.data(), &place.on[1], place.across.data(), &place.across[1]});
    const auto height = [&, &ia = ia, &ib = ib, &ic = ic](const IntegerPoint& point) {
        Integer sum = 0;
        for (unsigned axis = 0; axis < 3; ++axis) sum += line_value(ia, ib, ic, axis) * (point[axis] - ia[axis]);
        return sum;
    };
    return sign_between(height(begin), height(end), line_value(from, to, begin, place.axis),
                        line_value(from, to, end, place.axis));
}

int exact_line_side(const Place& place, const Point3d& a, const Point3d& b, unsigned axis) {
    const auto [ia, ib, begin, end, from, to] =
        integers_of<6>({&a, &b, place.on.data(), &place.on[1], place.across.data(), &place.across[1]});
    return sign_between(line_value(ia, ib, begin, axis), line_value(ia, ib, end, axis),
                        line_value(from, to, begin, place.axis), line_value(from, to, end, place.axis));
}

/// Returns the sign of an affine function at a place. side(point) returns its sign at a point, and between() its sign at the crossing.
template <typename Side, typename Between>
int side_of_place(const Place& place, const Side& side, const Between& between) {
    const int begin = side(place.on[0]);
    if (!place.crossing) return begin;
    const int end = side(place.on[1]);
    if (begin == 0 || end == 0) return begin + end;
    return begin == end ? begin : between();
}

/// Returns 1 if `a` is above `b`, -1 if it is below, 0 if they are equal.
int order(double a, double b) { return int(a > b) - int(a < b); }

}  // namespace

int NearbyPoint::plane_side(const Point3d& a, const Point3d& b, const Point3d& c) const {
    const PlaneSides plane(a, b, c);
    const auto side = [&](const Point3d& point) { return plane(point); };
    if (const int at = side_of_place(place, side, [&] { return exact_plane_side(place, a, b, c); })) return at;
    if (const int at = side(first)) return at;
    if (const int at = side(second)) return at;
    return sense == 0 ? 0 : sense * octopair::line_side(a, b, c, axis);
}

int NearbyPoint::line_side(const Point3d& a, const Point3d& b, unsigned along) const {
    const auto side = [&](const Point3d& point) { return octopair::line_side(a, b, point, along); };
    if (const int at = side_of_place(place, side, [&] { return exact_line_side(place, a, b, along); })) return at;
    if (const int at = side(first)) return at;
    if (const int at = side(second)) return at;
    // A point that moves upward gets to the left of a line that goes right. A point that moves right gets to the right of a line that
    // goes up.
    const unsigned u = (along + 1) % 3, v = (along + 2) % 3;
    if (axis == v) return sense * order(b[u], a[u]);
    if (axis == u) return -sense * order(b[v], a[v]);
    return 0;
}

Box3d NearbyPoint::box() const {
    Box3d box;
    for (std::size_t k = 0; k < 3; ++k) {
        std::tie(box.min[k], box.max[k]) =
            std::minmax(place.on[0][k], place.crossing ? place.on[1][k] : place.on[0][k]);
        if (!place.crossing) continue;
        box.min[k] = std::max(box.min[k], std::min(place.across[0][k], place.across[1][k]));
        box.max[k] = std::min(box.max[k], std::max(place.across[0][k], place.across[1][k]));
    }
    return box;
}

bool ray_crosses(const NearbyPoint& from, const Triangle3d& triangle) {
    const auto& [a, b, c] = triangle;
    const int side = from.line_side(a, b, 0);
    if (side == 0 || from.line_side(b, c, 0) != side || from.line_side(c, a, 0) != side) return false;
    // If `side` is 1, the projected triangle is counterclockwise and its normal points along the ray. So the ray reaches the
    // plane only from the side opposite to the normal.
    return from.plane_side(a, b, c) * side < 0;
}

}  // namespace octopair
