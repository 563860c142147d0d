// A posed mesh and a posed convex solid: whether they meet, where, and how far apart they are. Each triangle is tested as
// convex_pair.hpp does it; the hierarchy leaves out those that are too far away.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"

namespace octopair {

/// A solid with its box, as a tree of one node without triangles.
struct BoxedSolid {
    const ConvexSolid& solid;
    PosedMesh box;

    PosedConvex posed() const { return {solid, box.pose}; }
};

/// Whether some triangle meets the solid, which is full: one that lies inside does.
bool surface_meets(const PosedMesh& mesh, const BoxedSolid& solid);

/// Tells of all triangles that meet the solid, in an order that depends on the mesh alone: where it stands in the tree. Ends
/// where `tell` returns false.
void visit_meeting_triangles(const PosedMesh& mesh, const BoxedSolid& solid,
                             const std::function<bool(std::uint32_t at, const Triangle3d&)>& tell);

/// Whether the solid lies inside the mesh, whose surface must not meet it.
bool encloses_solid(const PosedMesh& mesh, const BoxedSolid& solid);

/// Whether the mesh lies inside the solid and does not reach its surface.
bool holds_mesh(const BoxedSolid& solid, const PosedMesh& mesh);

/// The distance of surface and solid, if it is at most `most`, else nothing.
std::optional<ConvexGap> surface_gap(const PosedMesh& mesh, const BoxedSolid& solid, double most);

}  // namespace octopair
