// Sorted lists: the entries of some objects by octant, made apart and merged. The paper's arrangement has them; whoever
// else builds an octree counts first, and puts each entry straight to its place (build_steps.hpp).
//
// Source: Lucchesi, Egbert, Harris 2014, section 3.3.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "boxes/entry.hpp"

namespace octopair {

/// The entries of some objects, sorted by octant: in each those of boxes whose home it is, then the others.
struct SortedList {
    std::span<const Entry> entries;
    std::span<const std::uint64_t> home_begins, ghost_begins;  ///< in each octant
};

/// Where a merged list goes, which may then be merged itself.
struct MergedList {
    std::span<Entry> entries;                            ///< as many as the lists have
    std::span<std::uint64_t> home_begins, ghost_begins;  ///< of each octant; nobody may want the second: empty
};

/// Merges lists of the same octants whose objects follow each other, one octant after another. Returns how many entries there
/// are. Throws Error{cancelled}.
std::uint64_t merge_lists(std::span<const SortedList> lists, const MergedList& merged, const std::stop_token& stop);

}  // namespace octopair
