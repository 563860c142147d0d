// Translations that may separate two objects: directions to try, and how far a translation along a direction must go.
#pragma once

#include <span>
#include <vector>

#include "narrow_phase/mesh/mesh_convex.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "octopair/collision.hpp"

namespace octopair {

/// Returns directions along which a motion of b may separate two objects: the different normals of the first 16 contacts, and the
/// axes in both senses.
std::vector<Point3d> directions_out(std::span<const Contact> contacts);

/// Return the length of a translation of b along `direction`, of length 1, after which a plane separates the objects: an upper
/// bound of the least separating translation. Requires: the objects are not empty.
double overlap_along(const Point3d& direction, const PosedMesh& a, const PosedMesh& b);
double overlap_along(const Point3d& direction, const PosedMesh& a, const BoxedSolid& b);

}  // namespace octopair
