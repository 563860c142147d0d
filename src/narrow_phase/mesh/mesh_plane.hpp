// A posed mesh and a plane: whether they meet, and their distance.
#pragma once

#include <optional>

#include "narrow_phase/convex/convex_plane.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"

namespace octopair {

/// Returns true if some triangle meets the plane.
bool surface_meets(const PosedMesh& mesh, const PosedPlane& plane);

/// Returns the interval that the mesh covers along the plane's normal; nothing for a mesh without triangles.
std::optional<PlaneSpan> span_across(const PosedPlane& plane, const PosedMesh& mesh);

/// Returns the gap between the plane (a) and the triangle nearest to it (b); nothing for a mesh without triangles.
std::optional<ConvexGap> plane_gap(const PosedPlane& plane, const PosedMesh& mesh);

}  // namespace octopair
