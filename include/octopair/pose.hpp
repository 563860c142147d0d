// Points, triangles and poses: the plain data of places in space, in float64.
//
// Units     Lengths are in the caller's unit. A Point3d is x, y, z.
// Ownership All types are plain values.
#pragma once

#include <array>

namespace octopair {

using Point3d = std::array<double, 3>;

/// A triangle in the world: its three corners.
using Triangle3d = std::array<Point3d, 3>;

/// Maps x to (the first three columns) * x + (the last column). All numbers are finite. Meshes and convex hulls accept any such
/// map: scaled, sheared, mirrored. Other shapes accept a rotation and a translation: columns of length 1, perpendicular to
/// 1e-6, not mirrored.
struct Pose {
    std::array<std::array<double, 4>, 3> rows = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
};

/// Returns the pose that rotates by `turn` and then moves to `place`.
/// Requires: `turn` is a quaternion w, x, y, z of any length but 0.
/// Throws: Error{bad_input} if `turn` is 0 or not finite.
/// CMake: link octopair::octopair.
Pose make_pose(const Point3d& place, const std::array<double, 4>& turn = {1, 0, 0, 0});

}  // namespace octopair
