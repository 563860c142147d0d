// Verdicts on pairs with a mesh: bounds on the distance of its triangles, signs of volumes, and winding numbers.
#pragma once

#include <array>
#include <stop_token>
#include <vector>

#include "verification/shapes/convex_verdict.hpp"

namespace octopair::certificate {

using Triangle = std::array<Vector, 3>;

/// Returns the triangles of an object in the world; none if it is not a mesh.
std::vector<Triangle> triangles_of(const JudgedObject& object);
/// Returns the triangles of an object in its own coordinates.
std::vector<Triangle> local_triangles_of(const JudgedObject& object);
/// Returns a lower bound on the distance of a point from triangles: their distance, or a number above `limit`. Complexity: linear.
Real least_distance(const Point3d& point, const std::vector<Triangle>& triangles, Real limit);

/// Judges two objects of which at least one is a mesh, and neither is a plane. Requires: a mesh has a triangle.
/// Depths and contacts are not checked. Throws: Error{cancelled}.
PairVerdict judge_meshes(const JudgedPair& pair, const Decision& decision, const std::stop_token& stop);

}  // namespace octopair::certificate
