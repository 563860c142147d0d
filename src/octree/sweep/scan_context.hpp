// ScanContext: parameters of a scan, which all its shares and sweeps read.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>

#include "boxes/entry.hpp"
#include "boxes/entry_source.hpp"
#include "octopair/error.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// An octant of the outermost octree. With test hooks, a scan checks each pair that it reports in the octant: the octant must hold the
/// low corner of the pair's intersection, as the rule of boxes/entry.hpp says.
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

class ScanMemoryPool;

struct ScanContext {
    const EntrySource& source;
    std::stop_token stop;
    ScanMemoryPool& memory;  ///< lends memory to each share
    unsigned nesting = 0;    ///< number of octrees around the scanned one
    double growth = 1;       ///< product over all nestings of (entries of the nested octree / entries before it)
    std::optional<OutermostOctant> outermost = {};  ///< set only with test hooks
};

}  // namespace octopair
