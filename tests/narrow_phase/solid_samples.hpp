// Closed meshes for tests: prisms of outlines, solids of revolution, combs. All are oriented outward.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <vector>

#include "octopair/shapes.hpp"

namespace octopair::test {

using Point2d = std::array<double, 2>;
using Outline = std::vector<Point2d>;  ///< counterclockwise

/// Returns a regular polygon around the origin.
Outline regular_outline(unsigned corners, double radius);
Outline rectangle(double half_width, double half_height);
/// Returns the outline of a gear: trapezoids between two radii.
Outline gear_outline(unsigned teeth, double inner, double outer);
/// Returns the outline with all points at `factor` times the distance from the origin.
Outline scaled(Outline outline, double factor);

/// Returns the prism between z = low and z = high of an outline that is star-shaped around the origin.
shape::Mesh prism(const Outline& outline, double low, double high);
/// Returns the prism of the ring between two outlines with equally many corners.
shape::Mesh ring(const Outline& outer, const Outline& inner, double low, double high);

/// Returns the solid that a profile of points (radius, z) makes around the z axis. An open profile goes from the top of the axis to its bottom;
/// a closed one is clockwise in the half plane with the radius to the right.
shape::Mesh revolved(const std::vector<Point2d>& profile, unsigned segments, bool closed);

/// Returns a comb: between z = floor and z = top[i] at x = xs[i], straight between these places, from y = 0 to y = depth.
shape::Mesh comb(const std::vector<double>& xs, const std::vector<double>& top, double floor, double depth);

/// Returns both meshes as one.
shape::Mesh joined(shape::Mesh first, const shape::Mesh& second);
/// Returns the mesh with its inside and outside exchanged, for cavities.
shape::Mesh turned_inside_out(shape::Mesh mesh);
shape::Mesh moved(shape::Mesh mesh, const Point3d& by);

}  // namespace octopair::test
