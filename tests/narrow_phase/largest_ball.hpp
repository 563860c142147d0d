// A dense search for the largest ball in two closed meshes, as an oracle. Shares no code with the library: distances to triangles by
// projection, inside by solid angles.
#pragma once

#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair::test {

/// Returns the diameter of a ball that lies in both solids, the largest that a grid of `steps` points an axis and a descent from its best points
/// find; 0 if they find none. It is a lower bound of the thickness, up to rounding. Requires: both meshes are oriented.
double largest_ball(const shape::Mesh& a, const shape::Mesh& b, unsigned steps);

}  // namespace octopair::test
