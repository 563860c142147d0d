// Orientation predicates: on which side of a plane or line a point lies. Exact for all finite float64 coordinates.
// geometry/exact_sign.hpp describes how the signs are computed.
#pragma once

#include <array>
#include <cmath>

#include "geometry/exact_sign.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// Returns the sign of plane_side(), -1, 0 or 1, computed with integers. Slow.
int exact_plane_side(const Point3d& a, const Point3d& b, const Point3d& c, const Point3d& d);

namespace filter {

inline constexpr double plane_error = 0x1p-50;  ///< above (7 + 56 * 2^-53) * 2^-53

}  // namespace filter

/// The plane through three corners. Decides the sides of several points.
class PlaneSides {
public:
    /// Borrows the corners: they must outlive this object.
    PlaneSides(const Point3d& a, const Point3d& b, const Point3d& c) : a_(a), b_(b), c_(c) {
        const double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
        const double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
        const double bycz = by * cz, bzcy = bz * cy, bzcx = bz * cx, bxcz = bx * cz, bxcy = bx * cy, bycx = by * cx;
        normal_ = {bycz - bzcy, bzcx - bxcz, bxcy - bycx};
        largest_ = {std::abs(bycz) + std::abs(bzcy), std::abs(bzcx) + std::abs(bxcz), std::abs(bxcy) + std::abs(bycx)};
    }
    explicit PlaneSides(const std::array<Point3d, 3>& triangle) : PlaneSides(triangle[0], triangle[1], triangle[2]) {}

    /// Returns 1 if d is on the side that (b - a) x (c - a) points to: a, b, c are counterclockwise, seen from d. Returns -1 if
    /// d is on the other side, 0 if the four points lie in one plane.
    int operator()(const Point3d& d) const {
        const int sign = rounded(d);
        return sign != 0 ? sign : exact_plane_side(a_, b_, c_, d);
    }

    /// Returns the sign of operator() if float64 decides it, otherwise 0.
    int rounded(const Point3d& d) const {
        const double dx = d[0] - a_[0], dy = d[1] - a_[1], dz = d[2] - a_[2];
        const double sum = dx * normal_[0] + dy * normal_[1] + dz * normal_[2];
        const double x = std::abs(dx), y = std::abs(dy), z = std::abs(dz);
        const double permanent = x * largest_[0] + y * largest_[1] + z * largest_[2];
        return filter::safe_sign(sum, filter::plane_error * permanent + filter::underflow * (1 + x + y + z));
    }

private:
    const Point3d &a_, &b_, &c_;
    Point3d normal_, largest_;
};

/// Returns PlaneSides(a, b, c)(d).
inline int plane_side(const Point3d& a, const Point3d& b, const Point3d& c, const Point3d& d) {
    return PlaneSides(a, b, c)(d);
}

}  // namespace octopair
