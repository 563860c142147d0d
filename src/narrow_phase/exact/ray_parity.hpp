// Rays and points against triangles, to decide whether a point is inside a closed mesh.
//
// A ray may pass through edges and corners. Ties are broken by symbolic perturbation, with an infinitesimal e > 0: the start
// of the ray counts as moved by e on one axis across the ray and by e^2 on the other. The moved ray crosses only interiors of
// triangles, and a point that is not on the surface stays on the same side of the surface.
#pragma once

#include "octopair/pose.hpp"

namespace octopair {

/// Returns true if the ray from `from` in the positive direction of `axis` (0, 1 or 2) crosses the triangle.
///
/// For a mesh in which each edge, by position, is in an even number of triangles: the ray crosses an odd number of triangles
/// exactly if `from` is inside. A point on the surface may give either parity.
bool ray_crosses(const Point3d& from, const Triangle3d& triangle, unsigned axis = 0);

/// Returns true if `place` is a point of the closed triangle.
bool point_on_triangle(const Point3d& place, const Triangle3d& triangle);

}  // namespace octopair
