// Rays and points against triangles, for what is inside a closed mesh.
//
// A ray may pass through edges and corners. Ties are broken as if it started from a place that is moved aside a little, by
// e on one axis across the ray and e^2 on the other, for an e that is smaller than any number: then it crosses insides
// only, and a place beside the surface is still on the same side of it.
#pragma once

#include "octopair/pose.hpp"

namespace octopair {

/// Whether the ray from a place, in the positive direction of `axis` (0, 1, 2), crosses the triangle. Of a mesh with each
/// edge in an even number of triangles, by position, an odd number of triangles is crossed exactly if the place is inside;
/// a place on the surface may get either answer.
bool ray_crosses(const Point3d& from, const Triangle3d& triangle, unsigned axis = 0);

/// Whether the place is one of the closed triangle's points.
bool point_on_triangle(const Point3d& place, const Triangle3d& triangle);

}  // namespace octopair
