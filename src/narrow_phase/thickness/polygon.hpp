// Polygon: a convex polygon in space, cut by planes and boxes.
//
// Rounding  A cut moves a point by a few roundings of its coordinates. Callers keep coordinates small: relative to a point nearby.
#pragma once

#include <optional>
#include <vector>

#include "geometry/vector.hpp"
#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// The points x with normal * x = offset; those with normal * x < offset are below.
struct CutPlane {
    Point3d normal;  ///< length 1
    double offset;

    double height(const Point3d& point) const { return vector::dot(normal, point) - offset; }
};

struct Polygon {
    std::vector<Point3d> corners;  ///< in order

    bool empty() const { return corners.size() < 3; }
};

/// Least and greatest coordinate along a direction.
struct Extent {
    double low, high;
};
Extent extent_along(const Point3d& direction, const Polygon& polygon);

/// Returns the vector with length 1; nothing if it is shorter than 1e-3, so that rounding could turn it.
std::optional<Point3d> direction_of(const Point3d& way);

Point3d middle_of(const Polygon& polygon);
Point3d middle_of(const Box3d& box);
bool contains(const Box3d& box, const Point3d& point);

/// Returns the area of the polygon.
double area_of(const Polygon& polygon);

/// Returns the part of a triangle in a box; empty if they do not meet.
Polygon clipped(const Triangle3d& triangle, const Box3d& box);

/// The parts of a polygon below and above a plane.
struct SplitPolygon {
    Polygon below,
        above;  ///< empty if the polygon does not reach further than `rounding` beyond the plane on this side
};
SplitPolygon split(const Polygon& polygon, const CutPlane& plane, double rounding);
/// Returns SplitPolygon::below alone.
Polygon cut_below(Polygon polygon, const CutPlane& plane, double rounding);

/// Returns the planes of the prism along `direction` over points: its sides touch the convex hull of the points. All points are below all
/// planes, up to a few roundings of their coordinates. Requires: `direction` has length 1.
std::vector<CutPlane> prism_over(const std::vector<Point3d>& points, const Point3d& direction);

}  // namespace octopair
