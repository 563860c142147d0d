// The paper's arrangement: each worker encodes and sorts some of the objects into a list of its own, and the client
// merges the lists and scans alone. It is there to be compared with.
//
// Source: Lucchesi, Egbert, Harris 2014, section 4.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/processes/shared_memory/arena.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

/// Where in the arena a list is; in the arena as well.
struct SortedListHead {
    std::uint64_t entries, entry_count;              ///< Entry
    std::uint64_t home_begins, ghost_begins, octants;  ///< of each octant's entries: those that are home, the others
    std::uint64_t valid, object_begin;               ///< whether all of its objects are boxes; the first of them
};

/// All lists of a pass, of which a worker makes some. All workers make the same SortedLists.
class SortedLists {
public:
    SortedLists(const EntrySource& source, Arena& arena, std::size_t lists, const std::stop_token& stop);

    /// Throws Error{cancelled}.
    void make(std::size_t list, const std::stop_token& stop);
    const SortedListHead* head(std::size_t list) const { return &heads_[list]; }

private:
    const EntrySource& source_;
    Arena& arena_;
    OctreeLayout layout_;
    std::vector<NumberedBlock> blocks_;
    BuildMemory memory_;
    std::vector<Buffer<Entry>> entries_;
    Buffer<SortedListHead> heads_;
};

/// What a list must fit.
struct ListBounds {
    std::uint64_t objects, octants;
};

/// The same list, as the client finds it. Throws Error{engine_failed} where it is not one.
SortedList find_list(SharedMemory& arena, std::uint64_t head, const ListBounds& bounds);

}  // namespace octopair
