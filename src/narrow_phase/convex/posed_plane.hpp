// PosedPlane: a plane in the world, given by one of its points and its normal of length 1.
//
// Requires: the pose is a rotation and a translation.
#pragma once

#include "geometry/vector.hpp"
#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

struct PosedPlane {
    Point3d normal, point;
};

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

}  // namespace octopair
