// Covers of an overlap by planks, in a convex domain.
//
// Cover     Planks such that no region of the domain outside of them lies in both solids. All pieces of the overlap's surface lie in planks, so
//           one point decides for a region.
// Opens     A plank opens if no two pieces of one solid in it face opposite ways along its normal: then a translation along the normal, as long
//           as the plank is wide, parts the solids there. Where few pieces face opposite to the others, further planks may cover the space
//           above and below them. An overlap that goes through a solid has no cover that opens.
#pragma once

#include <span>
#include <vector>

#include "narrow_phase/thickness/overlap_surface.hpp"
#include "narrow_phase/thickness/plank.hpp"

namespace octopair {

struct CoverRequest {
    const OverlapSurface& surface;
    const ConvexDomain& domain;
    std::span<const Piece> pieces;  ///< all pieces in the domain
    double most;                    ///< greatest sum of the widths
};

struct Cover {
    bool found = false;            ///< the planks cover the overlap in the domain, and open
    double width = 0;              ///< sum of the widths, if found
    std::vector<Point3d> in_both;  ///< points in both solids that the search met
};

/// Searches a cover. May miss one.
Cover find_cover(const CoverRequest& request);

/// Returns true if a layer of one solid goes through the other solid: all pieces are of one solid, and a line through the middle of `box` meets two
/// that face opposite ways, with the overlap between them. Then no cover of the domain opens. Requires: the domain contains all balls with a
/// centre in the box and the diameter `most`.
bool is_pierced(const CoverRequest& request, const Box3d& box);

}  // namespace octopair
