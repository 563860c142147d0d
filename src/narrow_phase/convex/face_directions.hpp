// propose_face_directions(): directions of separation that are exact where plane faces and straight edges touch.
//
// Use       A search ends when the bounds of the distance agree to the rounding of the pair's size. A direction is then accurate to about
//           this rounding, divided by the size. At the far points of a large face this still is much for a small object on it. The normal
//           of the face itself has no such error.
// Proposed  The normals of near faces of either core, the cross products of near edges of both, and the best direction made perpendicular
//           to each near edge. Of a core that is no set of points, the axes of its pose stand for normals and edges.
// Safety    Any direction is an upper bound of the least overlap. So a useless proposal only costs time.
#pragma once

#include "narrow_phase/convex/least_overlap.hpp"

namespace octopair {

/// Proposes directions near least.normal() until the overlap of the cores is at most `enough`.
/// Requires: a direction has been tried, and the sizes of the pair need no scaling (scaled_pair.hpp).
void propose_face_directions(const LocalConvexPair& pair, double enough, LeastOverlap& least);

}  // namespace octopair
