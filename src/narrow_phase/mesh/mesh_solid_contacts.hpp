// Contacts of a mesh and a convex solid that meet: depth and contacts.
//
// Samples   Corners and centroids of triangles, and the middle and the support points in 14 directions of the solid.
// Depth     The largest penetration depth of a triangle in the solid. For a closed mesh also the depth of the deepest sample
//           of one object inside the other, if that is larger.
// Contacts  One for each triangle that meets the solid, with the shortest translation that separates the two. For a closed
//           mesh the translation of the solid leads out of the mesh, never into it. Sorted by descending depth, then by the
//           number of the triangle.
#pragma once

#include <stop_token>

#include "narrow_phase/mesh/mesh_convex.hpp"
#include "octopair/collision.hpp"

namespace octopair {

struct MeshSolidRequest {
    double touching_depth;        ///< a contact that is at most this deep only touches
    const std::stop_token& stop;  ///< after a stop request the search ends soon; its result is then unspecified
};
/// Sets depth and contacts of `finding`; object a is the mesh.
void find_mesh_solid_contacts(const PosedMesh& mesh, const BoxedSolid& solid, const MeshSolidRequest& request,
                              Finding& finding);

/// Returns the depth of the deepest sample of either object inside the other; 0 if no sample is inside.
double depth_of_mesh_and_solid(const PosedMesh& mesh, const BoxedSolid& solid);

}  // namespace octopair
