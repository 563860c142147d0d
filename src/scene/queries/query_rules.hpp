// Tests of one box against one query: overlap and ray hit, by the rules of queries.hpp. Distances are in box_distance.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "octopair/queries.hpp"
#include "scene/queries/box_distance.hpp"

namespace octopair {

inline bool is_sphere(const Sphere& sphere) {
    return std::all_of(std::begin(sphere.centre), std::end(sphere.centre),
                       [](double at) { return std::isfinite(at); }) &&
           std::isfinite(sphere.radius) && sphere.radius >= 0;
}

inline bool is_ray(const Ray& ray) {
    const auto finite = [](double number) { return std::isfinite(number); };
    const auto zero = [](double number) { return number == 0; };
    return std::all_of(std::begin(ray.origin), std::end(ray.origin), finite) &&
           std::all_of(std::begin(ray.direction), std::end(ray.direction), finite) &&
           !std::all_of(std::begin(ray.direction), std::end(ray.direction), zero) && ray.longest >= 0;
}

/// Returns (bound - origin) / direction, even if the difference is beyond float64.
inline double along_axis(double bound, double origin, double direction) {
    const double way = bound - origin;
    return std::isinf(way) && std::isfinite(bound) ? (bound / 2 - origin / 2) / (direction / 2) : way / direction;
}

/// Returns the ray parameter at which the ray enters the box; nothing if it misses. The slab bounds of each axis have two
/// rounding errors, so the interval is widened by these: see Ize, Robust BVH Ray Traversal (JCGT 2, 2013).
inline std::optional<double> hit(const Ray& ray, const Box3d& box) {
    constexpr double roundings = 2 * std::numeric_limits<double>::epsilon();
    constexpr double underflow = std::numeric_limits<double>::min();
    double along = 0, enter = 0, leave = ray.longest;
    for (int axis = 0; axis < 3; ++axis) {
        const double origin = ray.origin[axis], direction = ray.direction[axis];
        if (direction == 0) {
            if (origin < box.min[axis] || origin > box.max[axis]) return std::nullopt;
            continue;
        }
        const double first = along_axis(box.min[axis], origin, direction);
        const double second = along_axis(box.max[axis], origin, direction);
        const double near = std::min(first, second), far = std::max(first, second);
        along = std::max(along, near);
        enter = std::max(enter, near * (1 - roundings) - underflow);
        leave = std::min(leave, far * (1 + roundings) + underflow);
    }
    if (!(enter <= leave) || std::isinf(along)) return std::nullopt;
    return along;
}

}  // namespace octopair
