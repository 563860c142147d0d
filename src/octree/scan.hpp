// Scan: one pass over the linear octree in pre-order that finds all pairs.
//
// In each octant its own entries are swept against each other and against the boxes handed down: the entries that
// octants above keep because they are too large for smaller ones, as far as they touch this octant. So octal codes on a
// common path meet, and no others (the paper's section 3.3, step 7). Which octant reports a pair is decided by
// entry.hpp's rule.
//
// An octant whose sweep would cost too much is first quantised afresh: its entries become a linear octree of their own.
// If that cannot thin them, recursive_sweep.hpp takes over. Both decisions are functions of the entries alone.
#pragma once

#include <functional>

#include "octree/linear_octree.hpp"
#include "octree/sweep/pair_maker.hpp"

namespace octopair {

/// The octants [begin, end) of an octree, in pre-order. Borrows it.
struct OctreeRange {
    OctreeRange(const LinearOctree& whole)  // NOLINT(google-explicit-constructor): a tree is a range of itself
        : OctreeRange(whole, 0, OctantIndex(whole.octants().size())) {}
    OctreeRange(const LinearOctree& tree, OctantIndex first, OctantIndex last) : octree(tree), begin(first), end(last) {}

    const LinearOctree& octree;
    OctantIndex begin, end;
};

/// Writes the pairs that these octants report, in pre-order. Of octants outside, only entries that reach into these are
/// read. `progress` (may be empty) is told how many entries are done, from any of
/// the executor's threads. Throws Error{cancelled}.
void scan(const OctreeRange& octants, const ScanContext& context, Executor& executor,
          const std::function<void(std::uint64_t)>& progress);

}  // namespace octopair
