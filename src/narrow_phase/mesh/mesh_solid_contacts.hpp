// Contacts of a mesh and a convex solid that meet: depth and contacts.
//
// Depth     Of a convex mesh: the least translation that separates the solids. Of others a lower bound: the largest penetration
//           depth of a triangle in the solid or, if that is larger, the depth of the deepest sample of one object inside the
//           other.
// Samples   Corners and centroids of triangles; the middle of the solid and its support points in 14 directions; of a hull
//           also the middles between contacts.
// Contacts  One for each triangle that meets the solid, with the shortest translation that separates the two. For a closed
//           mesh the translation of the solid leads out of the mesh, never into it. Sorted by descending depth, then by the
//           number of the triangle. Of more than max_contacts, the first ones in this order are kept; no more are in memory.
#pragma once

#include <cstdint>
#include <stop_token>

#include "narrow_phase/mesh/mesh_convex.hpp"
#include "octopair/collision.hpp"

namespace octopair {

struct MeshSolidRequest {
    std::uint32_t max_contacts;   ///< maximum number of contacts in the result
    double touching_depth;        ///< a contact that is at most this deep only touches
    double max_error;             ///< of a depth that counts as the least (is_solid())
    const std::stop_token& stop;  ///< after a stop request the search ends soon; its result is then unspecified
};
/// Sets depth and contacts of `finding`; object a is the mesh.
void find_mesh_solid_contacts(const PosedMesh& mesh, const BoxedSolid& solid, const MeshSolidRequest& request,
                              Finding& finding);

/// Sets depth and depth_kind: the least separating translation if is_solid(mesh, max_error); otherwise the depth of the deepest
/// sample of either object inside the other, a lower bound, or 0 if no sample is inside.
void set_depth_of_mesh_and_solid(const PosedMesh& mesh, const BoxedSolid& solid, double max_error, Finding& finding);

}  // namespace octopair
