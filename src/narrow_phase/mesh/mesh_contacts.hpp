// Contacts of two meshes that meet: class, depth and contacts.
//
// Samples   Corners and centroids of the triangles of one mesh, and the centre of its bounding box if it is inside the mesh.
// Class     Penetrating if two triangles pass through each other. For closed meshes also if a sample of one mesh is inside the
//           other, or if two coplanar triangles have the interiors of both meshes on the same side. Otherwise touching.
// Depth     Of penetrating meshes: the largest distance from a sample inside the other mesh to the other's surface. A
//           translation that separates the meshes is at least that long. If no sample is inside, or the meshes are open:
//           the depth of the deepest contact.
// Contacts  One for each pair of triangles that meet: the mean of their common points, with the normal and the depth of
//           these two triangles alone. Sorted by descending depth, then by the numbers of the triangles.
#pragma once

#include <cstdint>
#include <stop_token>

#include "narrow_phase/mesh/mesh_pair.hpp"
#include "octopair/collision.hpp"

namespace octopair {

/// Limits of the search for contacts of two objects that meet.
struct ContactRequest {
    std::uint32_t max_contacts;  ///< maximum number of contacts in the result
    /// After a stop request the search ends soon; its result is then unspecified. Borrowed.
    const std::stop_token& stop;
};

/// Sets class, depth and contacts of `finding`. Requires: the surfaces of the meshes meet.
void find_mesh_contacts(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request, Finding& finding);

/// Returns the depth of the deepest sample of either mesh inside the other; 0 if no sample is inside.
double depth_of_meshes(const PosedMesh& a, const PosedMesh& b, const std::stop_token& stop);

}  // namespace octopair
