// The octant that reports a pair: exactly one, although boxes may have entries in several octants.
// Start here to change which octant reports a pair.
//
// Rule        The octant that holds the low corner of the intersection of the two boxes reports the pair.
// Class bits  An entry has a class bit for each axis. The bit is set if the box begins before this octant (class_bits()), or before
//             an octant around it, up to the outermost octree. Octants below keep a bit that is set.
// Decision    An octant reports two of its entries only if no bit is set in both: (a.mask & b.mask) == 0. For if both boxes begin
//             before the octant on an axis, their intersection also does. The sweeps make this AND (sweep/sweep_kernel.cpp,
//             cell_sweep/cell_sweep_kernel.cpp). The other bits of Entry::mask (boxes/entry.hpp) take part in it.
// Dynamic     An octree that changes follows the same rule, by low ends that are 0 before a unit (dynamic/small_block.hpp).
// Nesting     The rule holds for any nesting of octrees. The proof is in docs/proofs.md ("Each pair once").
//
// Source: the classes are those of Tsitsigkos et al., arXiv 2307.09256.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "boxes/entry.hpp"
#include "octopair/error.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// Returns the axes, as class bits, on which `box` begins before `octant`.
inline std::uint32_t class_bits(const CellBox& box, const Octant& octant) {
    std::uint32_t axes = 0;
    for (unsigned axis = 0; axis < 3; ++axis) axes |= std::uint32_t(box.lo[axis] < octant.lo[axis]) << axis;
    return axes;
}

/// An octant of the outermost octree. With test hooks, a scan checks each pair that it reports in the octant: the octant must hold the
/// low corner of the pair's intersection.
struct OutermostOctant {
    Space space;
    Octant octant;

    /// Throws: Error{engine_failed} if another octant must report this pair.
    void check(const Entry& a, const Entry& b) const {
        for (unsigned axis = 0; axis < 3; ++axis) {
            const std::uint32_t low = space.map().cell(std::max(a.min[axis], b.min[axis]), axis);
            if (low >= octant.lo[axis] && low - octant.lo[axis] < cells_per_axis >> octant.level) continue;
            throw Error(ErrorCode::engine_failed, "objects " + std::to_string(a.object) + " and " +
                                                      std::to_string(b.object) +
                                                      " are reported in an octant without the "
                                                      "low corner of their intersection");
        }
    }
};

}  // namespace octopair
