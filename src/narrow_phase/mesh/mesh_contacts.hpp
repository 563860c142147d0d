// How two meshes that meet do so: class, depth and contacts.
//
// Class     penetrating where two triangles pass through each other; of closed meshes also where two triangles lie in one
//           plane with both insides on one side of it, or where a corner or the middle of a triangle of the one is inside
//           the other, or the middle of one inside both. Else touching.
// Depth     of those that penetrate: how far the deepest of those corners and middles, or the middle of one that lies in
//           both, is from the other's surface, so both have to be moved by that much, or more, to end it. Where no such
//           place is inside, and of open meshes, that of the deepest contact.
// Contacts  one for each two triangles that meet: in the middle of what they have in common, with the normal and the depth
//           of these two alone. The deepest come first, then by the triangles' numbers.
#pragma once

#include <stop_token>

#include "narrow_phase/mesh/contact_request.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "octopair/collision.hpp"

namespace octopair {

/// Sets class, depth and contacts of a finding. For meshes whose surfaces meet.
void find_mesh_contacts(const PosedMesh& a, const PosedMesh& b, const ContactRequest& request, Finding& finding);

/// How far the deepest of those places of either is inside the other; 0 if none is.
double depth_of_meshes(const PosedMesh& a, const PosedMesh& b, const std::stop_token& stop);

}  // namespace octopair
