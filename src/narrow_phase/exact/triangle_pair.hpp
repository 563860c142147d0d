// Pairs of triangles: the exact test, used by all stages (triangle_pair.cpp), and the distance (triangle_gap.cpp).
//
// Sets      Triangles are closed sets of points. A degenerate triangle is a segment or a point.
// Exact     The test has no epsilon: every decision is a sign from orientation.hpp.
// Symmetry  The result does not depend on the order of the two triangles or of their corners.
#pragma once

#include <array>

#include "octopair/pose.hpp"

namespace octopair {

/// Returns true if the triangles have a point in common.
bool triangles_meet(const Triangle3d& a, const Triangle3d& b);

/// Returns true if the triangles have a point in common outside their shared feature: one corner, the segment between two
/// corners, or the edges between three. So equal triangles meet beyond it unless they are degenerate.
bool meet_beyond_shared(const Triangle3d& a, const Triangle3d& b);

/// Returns true if all corners lie on a line.
bool is_degenerate(const Triangle3d& triangle);

/// Distance of two triangles, in float64.
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
