// Ellipsoid The surface of each solid consists of planes, and of places where a quadratic function is 0. Its greatest value in the
//           ellipsoid is known (greatest_on_ball()). So the answer is proven, up to rounding.
// Capsule   Between its ends it is a cylinder, beyond them a ball. The part of the ellipsoid beyond an end is divided into slabs until
//           the greatest distance in each is proven. Without a proof after many slabs, the ellipsoid counts as not below.
#include "narrow_phase/convex/below_surface.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry/vector.hpp"

namespace octopair {
namespace {

/// The function y -> y' square y + 2 linear' y + constant. The matrix is symmetric.
struct Quadratic {
    Eigen::Matrix3d square;
    Eigen::Vector3d linear;
    double constant;
};

using Vector = Eigen::Vector3d;

constexpr double unit_roundoff = std::numeric_limits<double>::epsilon();

/// Returns the least m between `below` and `above` for which the concave function of greatest_on_ball() has its maximum within the
/// unit ball. The maximum is at y(m), so |y(m)| <= 1.
double least_multiplier(const Vector& eigenvalues, const Vector& linear, double below, double above) {
    const auto is_in_ball = [&](double m) {
        return (linear.array() / (m - eigenvalues.array())).matrix().squaredNorm() <= 1;
    };
    for (int step = 0; step < 60; ++step) {
        const double middle = below + (above - below) / 2;
        if (!(middle > below && middle < above)) break;
        (is_in_ball(middle) ? above : below) = middle;
    }
    return above;
}

/// Returns |offset + map y|^2 as a function of y.
Quadratic squared_length(const Vector& offset, const Eigen::Matrix3d& map) {
    return {map.transpose() * map, map.transpose() * offset, offset.squaredNorm()};
}

/// Returns (offset + along' y)^2 as a function of y.
Quadratic squared(double offset, const Vector& along) {
    return {along * along.transpose(), along * offset, offset * offset};
}

/// Returns a number that the function exceeds nowhere in the unit ball. It is the greatest value itself, up to rounding.
/// Requires: no intermediate result overflows.
///
/// Let m be above 0 and above all eigenvalues of the matrix. In the ball, f(y) <= f(y) + m (1 - y'y). The right side is concave, so
/// its greatest value is known: a bound for each m. The least of these bounds is the greatest value of f, also if f is neither
/// convex nor concave (S-lemma).
/// Source: Polik, Terlaky: A survey of the S-lemma, SIAM Review 49 (2007).
double greatest_on_ball(const Quadratic& function) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(function.square);
    const Vector& eigenvalues = solver.eigenvalues();
    const Vector linear = solver.eigenvectors().transpose() * function.linear;
    const double size = eigenvalues.cwiseAbs().maxCoeff() + linear.norm() + std::fabs(function.constant);
    // Eigenvalues err by a few roundings of the largest eigenvalue. So the multiplier exceeds them by more than this error.
    const double least =
        std::max(eigenvalues.maxCoeff(), 0.0) + 16 * unit_roundoff * size + std::numeric_limits<double>::min();
    const double m = least_multiplier(eigenvalues, linear, least, least + linear.norm());
    const Vector parts = linear.array().square() / (m - eigenvalues.array());
    return function.constant + m + parts.sum() + 64 * unit_roundoff * size;
}

using Core = ConvexSolid::Core;

double above_box(const Point3d& extents, const Point3d& at) {
    double height = -std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) height = std::max(height, std::fabs(at[axis]) - extents[axis]);
    return height;
}

double above_cylinder(const Point3d& extents, const Point3d& at) {
    return std::max(std::hypot(at[0], at[1]) - extents[0], std::fabs(at[2]) - extents[2]);
}

/// The normal of a cone's wall: its parts across the axis and along it.
struct WallNormal {
    double across, along;
};

WallNormal wall_normal(const Point3d& extents) {
    const double slant = std::hypot(extents[0], 2 * extents[2]);
    return {2 * extents[2] / slant, extents[0] / slant};
}

double above_cone(const Point3d& extents, const Point3d& at) {
    const WallNormal normal = wall_normal(extents);
    const double wall = normal.across * std::hypot(at[0], at[1]) + normal.along * (at[2] - extents[2]);
    return std::max(wall, -extents[2] - at[2]);
}

double above_ellipsoid(const Point3d& radii, const Point3d& at) {
    const double least = std::min({radii[0], radii[1], radii[2]});
    return (vector::length({at[0] / radii[0], at[1] / radii[1], at[2] / radii[2]}) - 1) * least;
}

/// Returns the height of a point above a capsule whose axis is z, or above a sphere, which is a capsule with equal end points.
double above_capsule(const ConvexSolid& solid, const Point3d& at) {
    const double half = solid.points.back()[2];
    return vector::length({at[0], at[1], at[2] - std::clamp(at[2], -half, half)}) - solid.radius;
}

/// Returns the sum of two functions, the second one multiplied by `by`.
Quadratic sum(const Quadratic& a, const Quadratic& b, double by) {
    return {a.square + by * b.square, a.linear + by * b.linear, a.constant + by * b.constant};
}

/// Returns true if the ellipsoid lies in the ball around the origin.
bool is_within_ball(const Ellipsoid& ellipsoid, double radius) {
    return greatest_on_ball(squared_length(ellipsoid.centre, ellipsoid.map)) < radius * radius;
}

bool is_within_wall(const Ellipsoid& ellipsoid, double radius) {
    return is_within_ball(ellipsoid.scaled({1, 1, 0}), radius);
}

bool is_below_box(const Point3d& extents, const Ellipsoid& ellipsoid, double slack) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(ellipsoid.farthest(axis) < extents[std::size_t(axis)] - slack)) return false;
    }
    return true;
}

bool is_below_cylinder(const Point3d& extents, const Ellipsoid& ellipsoid, double slack) {
    return extents[0] > slack && ellipsoid.farthest(2) < extents[2] - slack &&
           is_within_wall(ellipsoid, extents[0] - slack);
}

/// Returns true if the ellipsoid is more than `slack` below the surface of a cone. The height of a point above the wall is across *
/// (distance from the axis) - along * (distance below the tip), with the parts of WallNormal.
bool is_below_cone(const Point3d& extents, const Ellipsoid& ellipsoid, double slack) {
    const WallNormal normal = wall_normal(extents);
    const double room = normal.along * (extents[2] - ellipsoid.centre[2]) - slack;
    const Eigen::Vector3d change = -normal.along * ellipsoid.along(2);
    if (!(ellipsoid.lowest(2) > slack - extents[2] && room > change.norm())) return false;
    const Ellipsoid across = ellipsoid.scaled({normal.across, normal.across, 0});
    return greatest_on_ball(sum(squared_length(across.centre, across.map), squared(room, change), -1)) < 0;
}

bool is_below_ellipsoid(const Point3d& radii, const Ellipsoid& ellipsoid, double slack) {
    const double least = std::min({radii[0], radii[1], radii[2]});
    return slack < least &&
           is_within_ball(ellipsoid.scaled({1 / radii[0], 1 / radii[1], 1 / radii[2]}), 1 - slack / least);
}

/// Returns true if the part of the ellipsoid with `from` <= z <= `to` is proven to lie in the ball around the origin.
bool slab_is_within_ball(const Ellipsoid& ellipsoid, double radius, double from, double to) {
    const Quadratic distance = squared_length(ellipsoid.centre, ellipsoid.map);
    // (z - middle)^2 - (half height)^2 is at most 0 in the slab. So a multiple of it, subtracted, lowers the function only outside.
    const double middle = (from + to) / 2, half = (to - from) / 2;
    Quadratic outside = squared(ellipsoid.centre[2] - middle, ellipsoid.along(2));
    outside.constant -= half * half;
    const auto greatest = [&](double multiple) { return greatest_on_ball(sum(distance, outside, -multiple)); };
    // The bound is a convex function of this multiple, so a golden-section search finds its minimum.
    constexpr double golden = std::numbers::phi - 1;
    double low = 0, high = 2 + 4 * radius / half;
    double first = high - golden * high, second = golden * high;
    double at_first = greatest(first), at_second = greatest(second);
    for (int step = 0; step < 40; ++step) {
        if (std::min(at_first, at_second) < radius * radius) return true;
        if (at_first < at_second) {
            high = second, second = first, at_second = at_first;
            first = high - golden * (high - low), at_first = greatest(first);
        } else {
            low = first, first = second, at_first = at_second;
            second = low + golden * (high - low), at_second = greatest(second);
        }
    }
    return false;
}

/// Returns true if a point of the ellipsoid above z = `from` is found that is outside of the ball around the origin.
bool sticks_out_of_ball(const Ellipsoid& ellipsoid, double radius, double from) {
    Eigen::Vector3d direction = {0, 0, 1};
    double farthest = 0;
    for (int step = 0; step < 32; ++step) {
        const Eigen::Vector3d y = ellipsoid.map.transpose() * direction;
        if (!(y.norm() > 0)) return false;
        const Eigen::Vector3d point = ellipsoid.centre + ellipsoid.map * y.normalized();
        if (point[2] < from) return false;
        if (point.norm() >= radius) return true;
        if (!(point.norm() > farthest)) return false;
        farthest = point.norm();
        direction = point;
    }
    return false;
}

/// Returns true if the part of the ellipsoid above z = `from` is proven to lie in the ball around the origin.
bool top_is_within_ball(const Ellipsoid& ellipsoid, double radius, double from) {
    if (ellipsoid.highest(2) <= from) return true;
    if (sticks_out_of_ball(ellipsoid, radius, from)) return false;
    constexpr int most_slabs = 64;
    std::vector<std::array<double, 2>> slabs = {{from, ellipsoid.highest(2)}};
    for (int tried = 0; !slabs.empty(); ++tried) {
        if (tried == most_slabs) return false;
        const auto [low, high] = slabs.back();
        slabs.pop_back();
        if (slab_is_within_ball(ellipsoid, radius, low, high)) continue;
        const double middle = (low + high) / 2;
        if (!(middle > low && middle < high)) return false;
        slabs.push_back({low, middle});
        slabs.push_back({middle, high});
    }
    return true;
}

bool is_below_capsule(const ConvexSolid& solid, const Ellipsoid& ellipsoid, double slack) {
    const double half = solid.points.back()[2], radius = solid.radius - slack;
    if (!(radius > 0)) return false;
    const double nearest = std::clamp(ellipsoid.centre[2], -half, half);
    if (is_within_ball(ellipsoid.moved({0, 0, -nearest}), radius)) return true;
    if (half == 0 || !is_within_wall(ellipsoid, radius)) return false;
    return top_is_within_ball(ellipsoid.moved({0, 0, -half}), radius, 0) &&
           top_is_within_ball(ellipsoid.scaled({1, 1, -1}).moved({0, 0, -half}), radius, 0);
}

}  // namespace

double height_above(const ConvexSolid& solid, const Point3d& at) {
    switch (solid.core) {
        case Core::points:
            return above_capsule(solid, at);
        case Core::box:
            return above_box(solid.extents, at);
        case Core::cylinder:
            return above_cylinder(solid.extents, at);
        case Core::cone:
            return above_cone(solid.extents, at);
        case Core::ellipsoid:
            break;
    }
    return above_ellipsoid(solid.extents, at);
}

bool is_below(const ConvexSolid& solid, const Ellipsoid& ellipsoid, double slack) {
    switch (solid.core) {
        case Core::points:
            return is_below_capsule(solid, ellipsoid, slack);
        case Core::box:
            return is_below_box(solid.extents, ellipsoid, slack);
        case Core::cylinder:
            return is_below_cylinder(solid.extents, ellipsoid, slack);
        case Core::cone:
            return is_below_cone(solid.extents, ellipsoid, slack);
        case Core::ellipsoid:
            break;
    }
    return is_below_ellipsoid(solid.extents, ellipsoid, slack);
}

}  // namespace octopair
