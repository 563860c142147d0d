// Contacts of two meshes that meet: class, depth and contacts.
//
// Class     Penetrating if two triangles pass through each other, or if the interiors meet (mesh_interiors.hpp); otherwise
//           touching. Exact.
// Depth     Of two convex meshes the least translation that separates them. Of others a lower bound: the largest distance
//           from a sample inside the other mesh to the other's surface, or the depth of the deepest contact.
// Samples   Corners and centroids of the triangles of one mesh, and the centre of its bounding box if it is inside the mesh.
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
    double tolerance = 0;            ///< what a translation of at most this length separates is touching
    double duplicate_tolerance = 0;  ///< largest distance of the corners of duplicates
    double max_error = 0;            ///< of a depth that counts as the least (is_solid())
};

/// Sets class, depth and contacts of `finding`. Requires: the surfaces of the meshes meet.
void find_mesh_contacts(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request, Finding& finding);

/// Returns true if the interiors of two meshes meet, or their surfaces pass through each other.
bool meshes_penetrate(const PosedMesh& a, const PosedMesh& b, const std::stop_token& stop);

/// Sets depth and depth_kind: the least separating translation of two convex meshes (MeshTree::solid); otherwise the depth of
/// the deepest sample of either mesh inside the other, a lower bound, or 0 if no sample is inside.
/// Requires: the interiors of the meshes meet.
void set_depth_of_meshes(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request, Finding& finding);

}  // namespace octopair
