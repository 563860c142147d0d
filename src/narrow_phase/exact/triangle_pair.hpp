// Whether two triangles meet: the one exact test of triangles, for all stages.
//
// Triangles are closed sets of points; those that are degenerate are the segments and points that they are. There is no
// epsilon: every decision is a sign of orientation.hpp, and none depends on the order of the two or of their corners.
#pragma once

#include "octopair/pose.hpp"

namespace octopair {

/// True if they have a point in common.
bool triangles_meet(const Triangle3d& a, const Triangle3d& b);

/// How many places are a corner of both: 0 to 3. Those that share one are adjacent.
unsigned shared_corners(const Triangle3d& a, const Triangle3d& b);

/// True if they have a point in common outside of what they share by their corners: one corner, the segment between two,
/// or the edges between three (so that equal triangles meet beyond these unless they are degenerate).
bool meet_beyond_shared(const Triangle3d& a, const Triangle3d& b);

/// True if all corners lie on a line.
bool is_degenerate(const Triangle3d& triangle);

}  // namespace octopair
