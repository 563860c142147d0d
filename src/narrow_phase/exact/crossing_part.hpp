// Where a segment crosses a plane or a line that its ends are on different sides of: not exact, but right to a few roundings
// however narrow the angle is. Where float64 cannot tell the heights of the ends, they are computed as integers.
#pragma once

#include "octopair/pose.hpp"

namespace octopair {

/// As a part of the way from begin to end, 0 to 1; the triangle lies in the plane. One end may lie in it, not both.
double part_to_plane(const Triangle3d& triangle, const Point3d& begin, const Point3d& end);

/// The line through a and b, seen along an axis, as line_side sees it.
struct ProjectedLine {
    const Point3d &a, &b;
    unsigned axis;
};
double part_to_line(const ProjectedLine& line, const Point3d& begin, const Point3d& end);

}  // namespace octopair
