// Where a segment crosses a plane or a line that has its two ends on different sides.
//
// The result is not exact, but right to a few roundings even if the angle is narrow. If float64 cannot determine the heights of
// the ends above the plane or line, exact integer arithmetic computes them.
#pragma once

#include "octopair/pose.hpp"

namespace octopair {

/// Returns the crossing with the triangle's plane as a fraction of the segment, 0 at `begin` and 1 at `end`.
/// Requires: the ends are not on the same side; at most one of them lies in the plane.
double part_to_plane(const Triangle3d& triangle, const Point3d& begin, const Point3d& end);

/// The line through a and b, projected along `axis`, as in line_side().
struct ProjectedLine {
    const Point3d &a, &b;
    unsigned axis;
};
/// Returns the same fraction for the crossing with a projected line.
double part_to_line(const ProjectedLine& line, const Point3d& begin, const Point3d& end);

}  // namespace octopair
