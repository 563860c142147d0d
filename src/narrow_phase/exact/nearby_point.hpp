// NearbyPoint: a point infinitesimally near a place in the plane of a triangle. Tells exactly on which side of planes and lines it is.
//
// Place     A given point, or the crossing of two segments that lie in one plane.
// Nearness  The place is moved by e towards a first point, by e^2 towards a second point, and by e^3 along an axis, with an
//           infinitesimal e > 0. So one point stands for a whole region beside the place.
// Signs     Sides are affine functions. The side of the nearby point is that of the place. If the place is on the plane or
//           line, it is that of the first point, then that of the second, then the side that the axis leads to.
#pragma once

#include "narrow_phase/exact/segment_pair.hpp"
#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// The point where `on` crosses `across`, both in one plane, projected along `axis` (line_side()); each has the ends of the
/// other on different sides. If there is no crossing, the place is on[0].
struct Place {
    Segment3d on;
    bool crossing = false;
    Segment3d across = {};
    unsigned axis = 0;

    static Place at(const Point3d& point) { return {{point, point}}; }
    static Place of(const Segment3d& on, const Segment3d& across, unsigned axis) { return {on, true, across, axis}; }
};

struct NearbyPoint {
    NearbyPoint(const Place& at, const Point3d& towards, const Point3d& then_towards, unsigned then_along)
        : place(at), first(towards), second(then_towards), axis(then_along) {}

    Place place;
    Point3d first, second;  ///< points that the place is moved towards
    unsigned axis;          ///< axis that the place is moved along
    int sense = 0;          ///< 1 or -1: upward or downward; 0: not moved along the axis

    /// Returns plane_side() of this point. 0 only if the plane contains the place and both points, and also the axis if
    /// `sense` is not 0.
    int plane_side(const Point3d& a, const Point3d& b, const Point3d& c) const;
    /// Returns line_side() of this point, projected along `along`.
    int line_side(const Point3d& a, const Point3d& b, unsigned along) const;
    /// Bounding box of the place.
    Box3d box() const;
};

/// Returns true if the ray from the point along the x axis crosses the triangle.
/// Requires: `sense` is not 0, and the place, the two points and the axis are not in one plane.
bool ray_crosses(const NearbyPoint& from, const Triangle3d& triangle);

}  // namespace octopair
