// How far apart two triangles are, in float64.
#pragma once

#include <array>

#include "octopair/filters.hpp"

namespace octopair {

struct TriangleGap {
    double distance = 0;
    std::array<Point3d, 2> nearest = {};  ///< a point of the first and one of the second, that far apart
};

/// 0 if they meet, by the exact test; otherwise right to a few roundings of the largest coordinate, also of degenerate
/// triangles.
TriangleGap triangle_gap(const Triangle3d& a, const Triangle3d& b);

}  // namespace octopair
