// The exact triangle-triangle test, used by all stages.
//
// Sets      Triangles are closed sets of points. A degenerate triangle is a segment or a point.
// Exact     There is no epsilon: every decision is a sign from orientation.hpp.
// Symmetry  The result does not depend on the order of the two triangles or of their corners.
#pragma once

#include "octopair/pose.hpp"

namespace octopair {

/// Returns true if the triangles have a point in common.
bool triangles_meet(const Triangle3d& a, const Triangle3d& b);

/// Returns true if the triangles have a point in common outside their shared feature: one corner, the segment between two
/// corners, or the edges between three. So equal triangles meet beyond it unless they are degenerate.
bool meet_beyond_shared(const Triangle3d& a, const Triangle3d& b);

/// Returns true if all corners lie on a line.
bool is_degenerate(const Triangle3d& triangle);

}  // namespace octopair
