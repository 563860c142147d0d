// A plane in the world: a point of it and its normal, of length 1. The normal is the pose's turn of the shape's; poses of
// planes turn and move only.
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

/// Below 0 on the side that the normal leads away from.
inline double height_above(const PosedPlane& plane, const Point3d& point) {
    return vector::dot(vector::minus(point, plane.point), plane.normal);
}

}  // namespace octopair
