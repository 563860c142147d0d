// Whether two objects are the same: equal geometry in the same place.
#pragma once

#include "narrow_phase/object_pair.hpp"

namespace octopair {

/// Returns true if the objects have the same kind of shape and equal sizes, and meshes equal triangles, and if no corner is further
/// than `tolerance` from its counterpart. For curved shapes the corners are those of their box. A shape that a symmetry maps to
/// itself is the same only in the same position.
bool are_duplicates(const PosedObject& a, const PosedObject& b, double tolerance);

}  // namespace octopair
