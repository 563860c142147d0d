// Distance of two triangles, or of a point and a triangle, in float64.
#pragma once

#include <array>

#include "octopair/pose.hpp"

namespace octopair {

struct TriangleGap {
    double distance = 0;
    std::array<Point3d, 2> nearest = {};  ///< nearest points: one of the first triangle, one of the second
};

/// Returns the distance and the nearest points. The distance is 0 if the triangles meet by the exact test. Otherwise it is
/// right to a few roundings of the largest coordinate, for degenerate triangles too.
TriangleGap triangle_gap(const Triangle3d& a, const Triangle3d& b);

/// Returns the distance of a point and a triangle, with the same accuracy. Much cheaper.
double triangle_gap(const Point3d& point, const Triangle3d& triangle);

}  // namespace octopair
