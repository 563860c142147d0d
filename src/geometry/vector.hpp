// Operations on vectors of three float64 numbers, and poses applied to vectors.
//
// Every addition, subtraction and multiplication is rounded by itself, in the order written here: the compiler makes no fused
// multiply-add of them (-ffp-contract=off).
#pragma once

#include <cmath>
#include <cstddef>

#include "octopair/pose.hpp"

namespace octopair::vector {

inline Point3d plus(const Point3d& a, const Point3d& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Point3d minus(const Point3d& a, const Point3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point3d times(const Point3d& a, double by) { return {a[0] * by, a[1] * by, a[2] * by}; }
inline double dot(const Point3d& a, const Point3d& b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }
inline Point3d cross(const Point3d& a, const Point3d& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Returns the length, without overflow or underflow of intermediate results.
inline double length(const Point3d& a) { return std::hypot(a[0], a[1], a[2]); }

/// Returns a vector perpendicular to `way`; 0 if `way` is 0.
inline Point3d some_normal(const Point3d& way) {
    std::size_t least = 0;
    for (std::size_t axis = 1; axis < 3; ++axis) {
        if (std::abs(way[axis]) < std::abs(way[least])) least = axis;
    }
    Point3d unit = {};
    unit[least] = 1;
    return cross(way, unit);
}

inline Point3d column(const Pose& pose, std::size_t k) { return {pose.rows[0][k], pose.rows[1][k], pose.rows[2][k]}; }
inline Point3d place(const Pose& pose) { return column(pose, 3); }

/// Returns `v` multiplied by the pose's 3 x 3 matrix: its translation is not applied.
inline Point3d turned(const Pose& pose, const Point3d& v) {
    const auto& r = pose.rows;
    return {r[0][0] * v[0] + r[0][1] * v[1] + r[0][2] * v[2], r[1][0] * v[0] + r[1][1] * v[1] + r[1][2] * v[2],
            r[2][0] * v[0] + r[2][1] * v[1] + r[2][2] * v[2]};
}
/// Returns `v` multiplied by the transpose of the pose's 3 x 3 matrix. A rigid pose so turns a world direction into local
/// coordinates.
inline Point3d turned_back(const Pose& pose, const Point3d& v) {
    return {dot(column(pose, 0), v), dot(column(pose, 1), v), dot(column(pose, 2), v)};
}
/// Returns the world position of a vertex. shapes.hpp defines the order of these operations.
inline Point3d posed(const Pose& pose, const Point3d& v) {
    const auto coordinate = [&](const std::array<double, 4>& r) {
        return ((r[0] * v[0] + r[1] * v[1]) + r[2] * v[2]) + r[3];
    };
    return {coordinate(pose.rows[0]), coordinate(pose.rows[1]), coordinate(pose.rows[2])};
}

}  // namespace octopair::vector
