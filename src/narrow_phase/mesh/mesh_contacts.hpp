// Contacts of meshes that meet another mesh (mesh_contacts.cpp, mesh_interiors.cpp) or a convex solid (mesh_solid_contacts.cpp): class,
// depth and contacts.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "narrow_phase/mesh/mesh_convex.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "octopair/collision.hpp"

namespace octopair {

/// Limits of the search for contacts of two objects that meet.
struct ContactRequest {
    std::uint32_t max_contacts;  ///< maximum number of contacts in the result
    /// After a stop request the search ends soon; its result is then unspecified. Borrowed.
    const std::stop_token& stop;
    double tolerance = 0;            ///< objects that a translation of at most this length separates are touching
    double duplicate_tolerance = 0;  ///< largest distance of the corners of duplicates
    double max_error = 0;            ///< maximum error of a least depth (is_solid())
};

/// Sets class, depth and contacts of `finding`. Requires: the surfaces of the meshes meet.
void find_mesh_contacts(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request, Finding& finding);

/// Returns true if the interiors of two meshes meet, or their surfaces pass through each other.
bool meshes_penetrate(const PosedMesh& a, const PosedMesh& b, const std::stop_token& stop);

/// Two triangles that touch, by their places in the trees' order.
struct TouchingTriangles {
    std::uint32_t a, b;
};

/// Returns true if the interior of one mesh has points in common with the surface or the interior of the other; points on both
/// surfaces do not count. After a stop request the result is unspecified.
/// Requires: `touching` has all pairs of triangles that meet, and no two triangles pass through each other.
bool interiors_meet(const PosedMesh& a, const PosedMesh& b, std::span<const TouchingTriangles> touching,
                    const std::stop_token& stop);

/// Sets depth and depth_kind. For two convex meshes (MeshTree::solid), the depth is the least separating translation. For other
/// meshes it is a lower bound: the depth of the deepest sample of either mesh inside the other; 0 if no sample is inside.
/// Requires: the interiors of the meshes meet.
void set_depth_of_meshes(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request, Finding& finding);

struct MeshSolidRequest {
    std::uint32_t max_contacts;   ///< maximum number of contacts in the result
    double touching_depth;        ///< a contact that is at most this deep only touches
    double max_error;             ///< maximum error of a least depth (is_solid())
    const std::stop_token& stop;  ///< after a stop request the search ends soon; its result is then unspecified
};
/// Sets depth and contacts of `finding`; object a is the mesh.
void find_mesh_solid_contacts(const PosedMesh& mesh, const BoxedSolid& solid, const MeshSolidRequest& request,
                              Finding& finding);

/// Sets depth and depth_kind. If is_solid(mesh, max_error), the depth is the least separating translation. Otherwise it is a lower
/// bound: the depth of the deepest sample of either object inside the other; 0 if no sample is inside.
void set_depth_of_mesh_and_solid(const PosedMesh& mesh, const BoxedSolid& solid, double max_error, Finding& finding);

}  // namespace octopair
