// Meshes for tests, examples and benchmarks, constructed or random from a seed. Closed; counterclockwise seen from outside.
#pragma once

#include <cstdint>

#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"
#include "samples/random.hpp"

namespace octopair::samples {

/// Returns the axis-aligned box between two corners, of 12 triangles.
shape::Mesh box_mesh(const Point3d& min, const Point3d& max);

/// Returns a sphere around the origin, of 8 * 4^level triangles.
shape::Mesh sphere_mesh(double radius, unsigned level);

/// Parameters of a bumpy torus around the z axis. Its major radius is 1, its minor radius 0.35.
struct TorusRequest {
    std::uint32_t rings, sides;
    double bump = 0;  ///< largest random displacement of a vertex, as a part of the minor radius
    std::uint64_t seed = 1;
};
/// Returns a torus of 2 * rings * sides triangles.
shape::Mesh torus_mesh(const TorusRequest& request);

/// Returns a uniformly distributed rotation and a position in the cube [0, width)^3.
Pose random_pose(RandomStream& random, double width);

}  // namespace octopair::samples
