// A posed mesh and a plane.
#pragma once

#include <optional>

#include "narrow_phase/convex/convex_plane.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"

namespace octopair {

/// Whether a triangle meets the plane.
bool surface_meets(const PosedMesh& mesh, const PosedPlane& plane);

/// From where to where the mesh reaches across the plane; nothing of a mesh without triangles.
std::optional<PlaneSpan> span_across(const PosedPlane& plane, const PosedMesh& mesh);

/// The triangle that is nearest to the plane, as a gap from the plane to it. Nothing of a mesh without triangles.
std::optional<ConvexGap> plane_gap(const PosedPlane& plane, const PosedMesh& mesh);

}  // namespace octopair
