// Covers of an overlap by planks, in a convex domain: planks such that no region of the domain outside of them lies in both solids. All pieces of
// the overlap's surface lie in planks, so one point decides for a region.
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

/// An attempt to cover the overlap.
struct Cover {
    bool found = false;            ///< the planks cover the overlap in the domain
    double width = 0;              ///< sum of the widths, if found
    std::vector<Plank> planks;     ///< if found
    std::vector<Point3d> in_both;  ///< points in both solids that the attempt met
};

/// Tries some covers. May miss one.
std::vector<Cover> find_covers(const CoverRequest& request);

}  // namespace octopair
