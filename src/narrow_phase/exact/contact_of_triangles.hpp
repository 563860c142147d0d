// contact_of(): the Contact of two triangles that meet, as the exact filters report it.
#pragma once

#include "narrow_phase/exact/triangle_contact.hpp"
#include "octopair/collision.hpp"

namespace octopair {

/// Returns the contact: the mean of the common points, with the shortest translation that separates the triangles. The
/// features are left unset. Requires: the triangles meet; `common` is triangle_contact(a, b).
inline Contact contact_of(const Triangle3d& a, const Triangle3d& b, const TriangleContact& common) {
    Contact contact = {};
    for (unsigned i = 0; i < common.count; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) contact.point[axis] += common.points[i][axis] / common.count;
    }
    const TriangleDepth way_out = triangle_depth(a, b);
    contact.normal = way_out.normal;
    contact.depth = way_out.depth;
    return contact;
}

}  // namespace octopair
