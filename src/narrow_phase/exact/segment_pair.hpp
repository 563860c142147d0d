// Exact tests of segments against segments and triangles, all closed and possibly degenerate.
//
// Slow: the tests of triangles use these functions only for coplanar or degenerate triangles.
#pragma once

#include <array>

#include "octopair/pose.hpp"

namespace octopair {

/// The two ends of a segment. The ends may be equal.
using Segment3d = std::array<Point3d, 2>;

/// Projection of a triangle along an axis, in which the triangle has an area.
struct Projection {
    unsigned axis = 3;  ///< 3 if the triangle is degenerate
    int side = 0;       ///< 1: the projected triangle is counterclockwise, -1: clockwise, 0: degenerate
};
/// Returns the first axis along which the projected triangle has an area.
Projection projection_of(const Triangle3d& triangle);

/// Returns the two corners that are farthest apart. Requires: the triangle is degenerate.
Segment3d hull_of_degenerate(const Triangle3d& triangle);

/// Returns an axis along which the common plane of two segments is projected one to one; 3 if all ends lie on a line.
/// Requires: the segments lie in one plane.
unsigned projection_axis(const Segment3d& s, const Segment3d& t);

/// Returns true if the closed boxes of the segments overlap. If all ends lie on one line, then the segments meet.
bool boxes_meet(const Segment3d& s, const Segment3d& t);

bool segments_meet(const Segment3d& s, const Segment3d& t);
bool segment_meets_triangle(const Segment3d& segment, const Triangle3d& triangle);

}  // namespace octopair
