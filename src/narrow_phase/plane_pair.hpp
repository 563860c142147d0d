// Planes against convex objects and meshes: whether they meet, their distance and their contact.
//
// The farthest points on either side of the plane decide; there is no search. FCL's search misses planes that are far away.
#pragma once

#include <optional>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

/// A plane in the world, given by one of its points and its normal of length 1.
struct PosedPlane {
    Point3d normal, point;
};

/// Requires: the pose is a rotation and a translation.
inline PosedPlane posed_plane(const shape::Plane& plane, const Pose& pose) {
    const double length = vector::length(plane.normal);
    const Point3d normal = {plane.normal[0] / length, plane.normal[1] / length, plane.normal[2] / length};
    const Point3d turned = vector::turned(pose, normal);
    const Point3d point = vector::turned(pose, vector::times(normal, plane.offset / length));
    return {vector::times(turned, 1 / vector::length(turned)), vector::plus(point, vector::place(pose))};
}

/// Returns the signed distance of `point` from the plane: above 0 on the side that the normal points to.
inline double height_above(const PosedPlane& plane, const Point3d& point) {
    return vector::dot(vector::minus(point, plane.point), plane.normal);
}

/// Interval that an object covers along a plane's normal; 0 is the plane.
struct PlaneSpan {
    double low, high;         ///< signed distances from the plane, widened by the rounding error
    Point3d lowest, highest;  ///< points of the object at the ends of the interval
};

PlaneSpan span_across(const PosedPlane& plane, const PosedConvex& convex);

inline bool meets(const PlaneSpan& span) { return span.low <= 0 && span.high >= 0; }

/// plane_gap() returns the gap, and plane_contact() the contact, of the plane (a) and the object (b) that covers `span`.
ConvexGap plane_gap(const PosedPlane& plane, const PlaneSpan& span);
ConvexContact plane_contact(const PosedPlane& plane, const PlaneSpan& span);

/// Returns true if some triangle meets the plane.
bool surface_meets(const PosedMesh& mesh, const PosedPlane& plane);

/// Returns the interval that the mesh covers along the plane's normal; nothing for a mesh without triangles.
std::optional<PlaneSpan> span_across(const PosedPlane& plane, const PosedMesh& mesh);

/// Returns the gap between the plane (a) and the triangle nearest to it (b); nothing for a mesh without triangles.
std::optional<ConvexGap> plane_gap(const PosedPlane& plane, const PosedMesh& mesh);

}  // namespace octopair
