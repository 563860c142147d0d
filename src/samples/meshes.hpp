// Meshes for tests, examples and benchmarks, made by rule or from a seed; closed, and counterclockwise from outside.
#pragma once

#include <cstdint>

#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"
#include "samples/random.hpp"

namespace octopair::samples {

/// A box of 12 triangles between two corners.
shape::Mesh box_mesh(const Point3d& min, const Point3d& max);

/// A sphere around the origin, of 8 * 4^level triangles.
shape::Mesh sphere_mesh(double radius, unsigned level);

/// A bumpy torus around the z axis: 2 * rings * sides triangles. Its large radius is 1, the small one 0.35, and each vertex
/// is moved in or out by up to `bump` of that.
struct TorusRequest {
    std::uint32_t rings, sides;
    double bump = 0;
    std::uint64_t seed = 1;
};
shape::Mesh torus_mesh(const TorusRequest& request);

/// Any turn, as likely as any other, and a place in the cube from 0 to `width`.
Pose random_pose(RandomStream& random, double width);

}  // namespace octopair::samples
