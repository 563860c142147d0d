// Points, triangles and poses in float64: plain values.
//
// Units     Lengths are in the caller's unit. A Point3d is x, y, z.
// Ownership All types are plain values.
#pragma once

#include <array>

namespace [[gnu::visibility("default")]] octopair {

using Point3d = std::array<double, 3>;

/// The three corners of a triangle, in world coordinates.
using Triangle3d = std::array<Point3d, 3>;

/// An affine map: x becomes (the first three columns) * x + (the last column). All numbers are finite.
/// Meshes and convex hulls accept any such map: also scaling, shear and reflection. Other shapes accept only a rotation and a
/// translation: columns of length 1, perpendicular within 1e-6, no reflection.
struct Pose {
    std::array<std::array<double, 4>, 3> rows = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
};

/// Returns the pose that rotates by `turn` and then moves to `place`.
/// Requires: `turn` is a quaternion w, x, y, z of any length but 0.
/// Throws: Error{bad_input} if `turn` is 0 or not finite.
/// CMake: link octopair::octopair.
Pose make_pose(const Point3d& place, const std::array<double, 4>& turn = {1, 0, 0, 0});

}  // namespace octopair
