// Whether an overlap opens: whether small motions part the solids everywhere, as for a fit, or whether one solid goes through the other.
//
// Opens     A point of the overlap opens if some line through it leaves the overlap on one side through the surface of a, and on the other side
//           through the surface of b, and both places are at most the tolerance apart.
// Regions   The test takes convex regions. All lines along one direction through a region are tested together. If they do not open it, the planes
//           of pieces divide the region.
// Ends      The pieces within the tolerance of a region have all ends of such lines.
// Rounding  Regions that are nowhere wider than about `rounding` are left out.
#pragma once

#include <span>

#include "narrow_phase/thickness/overlap_surface.hpp"
#include "narrow_phase/thickness/plank.hpp"

namespace octopair {

struct OpenRequest {
    const OverlapSurface& surface;
    std::span<const Piece> pieces;  ///< all pieces within the tolerance of the box
    double most;                    ///< the tolerance
};

/// Returns true if the overlap opens in the region of the box that each plank covers. May miss that it opens.
bool opens(const OpenRequest& request, const Box3d& box, std::span<const Plank> planks);

/// Returns true if a point of the overlap in the box certainly does not open: the surface of the overlap within the tolerance is that of one
/// solid alone. May miss such points.
bool is_pierced(const OpenRequest& request, const Box3d& box);

}  // namespace octopair
