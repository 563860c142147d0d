// Whether points are inside a mesh, by winding numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "verification/shapes/mesh_verdict.hpp"

namespace octopair::certificate {

/// Where an object is whose surface does not meet that of another object.
struct Place {
    bool any_inside = false;   ///< a part of the object is certainly inside
    bool any_outside = false;  ///< a part of the object is certainly outside
    bool all_outside = false;  ///< all parts of the object are certainly outside
};

/// Returns one point of each connected part of a mesh. Parts are connected by corners in equal places.
std::vector<Vector> points_of_parts(const std::vector<Triangle>& mesh);

/// Returns where the parts of an object are that have these points. Nothing is certain if an edge of the mesh is not in as many triangles
/// of one direction as of the other: then the mesh is not closed, or its triangles are not turned alike.
/// Complexity: O(n log n + p n) for p points, of which at most 64 are tested.
Place place_in(const std::vector<Triangle>& mesh, const std::vector<Vector>& points);

}  // namespace octopair::certificate
