// Planes against convex things, by their farthest points on either side: no search, so FCL's, which misses planes that
// are far away, has no part in it.
#pragma once

#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/convex/posed_plane.hpp"

namespace octopair {

/// From where to where a thing reaches along a plane's normal, 0 being the plane.
struct PlaneSpan {
    double low, high;  ///< widened by what rounding may have taken
    Point3d lowest, highest;
};

PlaneSpan span_across(const PosedPlane& plane, const PosedConvex& convex);

inline bool meets(const PlaneSpan& span) { return span.low <= 0 && span.high >= 0; }

/// a: the plane.
ConvexGap plane_gap(const PosedPlane& plane, const PlaneSpan& span);
ConvexContact plane_contact(const PosedPlane& plane, const PlaneSpan& span);

}  // namespace octopair
