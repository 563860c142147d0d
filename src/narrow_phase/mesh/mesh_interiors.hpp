// Whether the interiors of two meshes that touch have a point in common. Exact.
//
// Touch     Triangles of the meshes meet, but none pass through each other. Then no triangle's interior is cut by an edge of
//           the other mesh, except by edges that lie in its plane. These edges divide the triangle into faces.
// Faces     Each face lies inside the other mesh, outside, or on its surface. If the interiors have points in common, so does
//           a face of a triangle that touches (its sides have, if it lies on the other surface), or a whole part that
//           touches nothing. One point near a corner of each face decides (nearby_point.hpp).
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "narrow_phase/mesh/mesh_pair.hpp"

namespace octopair {

/// Two triangles that touch, by their places in the trees' order.
struct TouchingTriangles {
    std::uint32_t a, b;
};

/// Returns true if the interior of one mesh has points in common with the surface or the interior of the other; points on both
/// surfaces do not count. After a stop request the result is unspecified.
/// Requires: `touching` has all pairs of triangles that meet, and no two triangles pass through each other.
bool interiors_meet(const PosedMesh& a, const PosedMesh& b, std::span<const TouchingTriangles> touching,
                    const std::stop_token& stop);

}  // namespace octopair
