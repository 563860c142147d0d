// SortedList: entries sorted by octant, in one piece of memory. The paper's arrangement makes such lists separately for parts of
// the objects, and then merges them. All other builds leave the entries in the lists of their octants (build_steps.hpp).
//
// Source: Lucchesi, Egbert, Harris 2014, section 3.3.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "base/private_export.hpp"
#include "octree/build/build_steps.hpp"
#include "octree/cell_sweep/cell_entry.hpp"

namespace octopair {

/// The entries of some objects, sorted by octant: in each octant home entries, then ghosts.
struct SortedList {
    std::span<const CellEntry> entries;
    std::span<const std::uint64_t> home_begins, ghost_begins;  ///< by octant: position of the first entry of this kind
};

/// Memory for a merged list, which can be merged again.
struct MergedList {
    std::span<CellEntry> entries;                        ///< room for the entries of all lists
    std::span<std::uint64_t> home_begins, ghost_begins;  ///< by octant; ghost_begins may be empty: not wanted
};

/// Returns the number of entries of a block of objects, in all its lists.
OCTOPAIR_PRIVATE_EXPORT std::uint64_t entry_count(const BuildMemory& memory, std::size_t block);
/// Copies the entries of a block of objects to one sorted list. Requires: `sorted` has room for entry_count() entries.
OCTOPAIR_PRIVATE_EXPORT void sort_block(const BuildMemory& memory, std::size_t block, const MergedList& sorted);

/// Merges lists of the same octants, one octant after another. Returns the number of entries.
/// Requires: the objects of each list precede those of the next.
/// Throws: Error{cancelled}.
OCTOPAIR_PRIVATE_EXPORT std::uint64_t merge_lists(std::span<const SortedList> lists, const MergedList& merged,
                                                  const std::stop_token& stop);

}  // namespace octopair
