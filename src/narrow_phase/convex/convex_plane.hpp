// Planes against convex objects.
//
// The farthest points on either side of the plane decide; there is no search. FCL's search misses planes that are far away.
#pragma once

#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/convex/posed_plane.hpp"

namespace octopair {

/// Interval that an object covers along a plane's normal; 0 is the plane.
struct PlaneSpan {
    double low, high;         ///< signed distances from the plane, widened by the rounding error
    Point3d lowest, highest;  ///< points of the object at the ends of the interval
};

PlaneSpan span_across(const PosedPlane& plane, const PosedConvex& convex);

inline bool meets(const PlaneSpan& span) { return span.low <= 0 && span.high >= 0; }

/// In the results of both functions, a is the plane and b the object.
ConvexGap plane_gap(const PosedPlane& plane, const PlaneSpan& span);
ConvexContact plane_contact(const PosedPlane& plane, const PlaneSpan& span);

}  // namespace octopair
