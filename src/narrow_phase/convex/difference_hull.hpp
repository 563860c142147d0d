// find_least_overlap(): the direction along which two cores overlap least, by an expanding polytope.
//
// Polytope  The convex hull of points of the difference a - b (least_overlap.hpp). It lies within the difference, so the
//           height of its face nearest to the origin is a lower bound on the overlap along every direction.
// Growth    The nearest face is replaced by the difference's farthest point along its normal. If there is no farther one, the
//           overlap along this normal is the least of all.
// Flat      If the difference has no volume, the overlap along its normal is the least.
// Source    G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", 2001. Here the
//           polytope need not contain the origin, so neither a first simplex around it nor touching cores are special.
#pragma once

#include "narrow_phase/convex/least_overlap.hpp"

namespace octopair {

/// Tries directions with `least` until the least overlap is found to `slack` or a relative 1e-10, or, of pairs with very many
/// directions of nearly least overlap, until the search gives up; the overlap is then right to the second order of the
/// distance to the best direction. Returns a proven lower bound on the least overlap, or minus infinity for a difference without
/// volume. `slack`: rounding error of a point of the difference.
double find_least_overlap(LeastOverlap& least, double slack);

}  // namespace octopair
