// A posed mesh and a posed convex solid: whether they meet, which triangles meet the solid, and their distance.
//
// convex_pair.hpp tests each triangle. The bounding hierarchy skips triangles that are too far away.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"

namespace octopair {

/// A posed convex solid with its bounding box: a tree of one node without triangles.
struct BoxedSolid {
    const ConvexSolid& solid;
    PosedMesh box;

    PosedConvex posed() const { return {solid, box.pose}; }
};

/// Returns true if some triangle meets the solid. A triangle inside the solid meets it.
bool surface_meets(const PosedMesh& mesh, const BoxedSolid& solid);

/// Calls visit(place in the tree's order, triangle) for each triangle that meets the solid. Ends when `visit` returns false.
/// The order depends only on the mesh.
void visit_meeting_triangles(const PosedMesh& mesh, const BoxedSolid& solid,
                             const std::function<bool(std::uint32_t at, const Triangle3d&)>& visit);

/// Returns true if the solid lies inside the mesh. Requires: the mesh's surface does not meet the solid.
bool encloses_solid(const PosedMesh& mesh, const BoxedSolid& solid);

/// Returns true if the mesh lies inside the solid and does not reach the solid's surface.
bool contains_mesh(const BoxedSolid& solid, const PosedMesh& mesh);

/// Returns the distance of the mesh's surface and the solid if it is at most `most`, otherwise nothing.
std::optional<ConvexGap> surface_gap(const PosedMesh& mesh, const BoxedSolid& solid, double most);

}  // namespace octopair
