// Bounds on the distance and on the depth of two convex bodies, each with a certificate.
//
//   distance  at most that of two points, one of each body; at least the gap between two parallel planes that separate the bodies
//   depth     length of the shortest translation that separates the bodies. At most the overlap along a direction; at least the radius of
//             a ball around the origin that the difference of the bodies contains
#pragma once

#include "verification/shapes/convex_body.hpp"

namespace octopair::certificate {

struct DistanceBounds {
    Real lower = 0, upper = 0;
    std::array<Vector, 2> points = {};  ///< a point of each body; their distance is `upper`
};

struct DepthBounds {
    Real lower = 0, upper = 0;
};

/// Returns the width of the gap between two bodies along a unit vector from the first to the second. Negative: they overlap there.
Real gap_along(const ConvexBody& first, const ConvexBody& second, const Vector& direction);

/// Improves both bounds until they agree to `accuracy`, until lower > `far_enough`, or until rounding ends the progress.
DistanceBounds bound_distance(const ConvexBody& first, const ConvexBody& second, Real accuracy, Real far_enough);

/// Improves both bounds until they agree to `accuracy`, until lower > `deep_enough`, or until rounding ends the progress.
DepthBounds bound_depth(const ConvexBody& first, const ConvexBody& second, Real accuracy, Real deep_enough);

}  // namespace octopair::certificate
