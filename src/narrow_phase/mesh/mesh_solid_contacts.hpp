// How a mesh and a convex solid that meet do so: depth and contacts.
//
// Depth     that of the triangle that needs the longest way out of the solid. Of a closed mesh also how far the deepest place of
//           the one is inside the other, if that is more: corners and middles of triangles, and of the solid its middle and
//           what is outermost in 14 directions.
// Contacts  one for each triangle that meets the solid: the least way that parts the two, but out of a closed mesh, never
//           into it. The deepest come first, then by number.
#pragma once

#include <stop_token>

#include "narrow_phase/mesh/mesh_convex.hpp"
#include "octopair/collision.hpp"

namespace octopair {

struct MeshSolidRequest {
    double touch;                 ///< depths below it are none
    const std::stop_token& stop;  ///< after a request the search ends soon, with any answer
};
/// Sets depth and contacts of a finding; a is the mesh.
void find_mesh_solid_contacts(const PosedMesh& mesh, const BoxedSolid& solid, const MeshSolidRequest& request,
                              Finding& finding);

/// How far the deepest place of either is inside the other; 0 if none is.
double depth_of_mesh_and_solid(const PosedMesh& mesh, const BoxedSolid& solid);

}  // namespace octopair
