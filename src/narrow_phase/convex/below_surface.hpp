// Points, balls and ellipsoids below the surface of a sphere, capsule, box, cylinder, cone or ellipsoid, in the coordinates of this solid.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "narrow_phase/convex/convex_solid.hpp"

namespace octopair {

/// An ellipsoid, perhaps a flat one: all centre + map y with |y| <= 1.
struct Ellipsoid {
    Eigen::Vector3d centre;
    Eigen::Matrix3d map;

    double highest(int axis) const { return centre[axis] + map.row(axis).norm(); }
    double lowest(int axis) const { return centre[axis] - map.row(axis).norm(); }
    double farthest(int axis) const { return std::max(highest(axis), -lowest(axis)); }
    /// Returns the coordinate on an axis, without its value at the centre, as a function of y.
    Eigen::Vector3d along(int axis) const { return map.row(axis); }
    /// Returns the ellipsoid in coordinates that are multiplied by `factors`.
    Ellipsoid scaled(const Eigen::Vector3d& factors) const {
        return {factors.cwiseProduct(centre), factors.asDiagonal() * map};
    }
    Ellipsoid moved(const Eigen::Vector3d& by) const { return {centre + by, map}; }
};

/// Returns the height of a point above the surface; it is negative inside. Inside, its absolute value is the distance from the surface;
/// for an ellipsoid it is a lower bound of this distance. So a ball inside reaches as high as its centre plus its radius, except in an
/// ellipsoid.
double height_above(const ConvexSolid& solid, const Point3d& at);

/// Returns true if the ellipsoid is proven to be more than `slack` below the surface of the solid.
bool is_below(const ConvexSolid& solid, const Ellipsoid& ellipsoid, double slack);

}  // namespace octopair
