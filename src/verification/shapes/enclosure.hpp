// Whether points are inside a mesh, by winding numbers.
#pragma once

#include <cstddef>
#include <vector>

#include "verification/shapes/verdicts.hpp"

namespace octopair::certificate {

/// Where the parts of an object are, relative to another object whose surface they do not meet.
struct Enclosure {
    bool is_known = false;     ///< false: the other object is an open mesh, or there are too many parts to test all
    bool any_inside = false;   ///< a part is certainly inside
    bool any_outside = false;  ///< a part is certainly outside
    bool all_outside = false;  ///< all parts are certainly outside
};

// The next two functions take the mesh in its own coordinates, not in the world: a pose rounds coordinates, which may close a gap.

/// Returns whether a mesh is closed and its triangles are consistently oriented: for each edge, equally many triangles run along it in
/// either direction. Complexity: O(n log n).
bool is_closed(const std::vector<Triangle>& mesh);

/// Returns the number of one triangle of each connected part of a mesh. Parts are connected by corners in equal places.
std::vector<std::size_t> parts_of(const std::vector<Triangle>& mesh);

/// Returns where the parts of an object are, given one point of each, relative to a closed mesh.
/// Complexity: O(p n) for p points, of which at most 64 are tested.
Enclosure enclosure_in(const std::vector<Triangle>& mesh, const std::vector<Vector>& points);

}  // namespace octopair::certificate
