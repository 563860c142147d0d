// How far apart two triangles are, or a point and one, in float64.
#pragma once

#include <array>

#include "octopair/pose.hpp"

namespace octopair {

struct TriangleGap {
    double distance = 0;
    std::array<Point3d, 2> nearest = {};  ///< a point of the first and one of the second, that far apart
};

/// 0 if they meet, by the exact test; otherwise right to a few roundings of the largest coordinate, also of degenerate
/// triangles.
TriangleGap triangle_gap(const Triangle3d& a, const Triangle3d& b);

/// The same distance of a point and a triangle, much cheaper.
double triangle_gap(const Point3d& point, const Triangle3d& triangle);

}  // namespace octopair
