// SortedLists: the sorted lists of the paper's arrangement, which serves as a baseline for comparison.
//
// Each list has the entries of one block of objects, which one worker encodes and sorts. The client alone merges the lists
// and scans.
//
// Source: Lucchesi, Egbert, Harris 2014, section 4.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/processes/shared_memory/arena.hpp"
#include "octree/build/sorted_list.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

/// Describes one list: offsets in the arena, and counts. Stored in the arena itself.
struct SortedListHead {
    std::uint64_t entries, entry_count;                ///< offset of the CellEntry array, and its length
    std::uint64_t home_begins, ghost_begins, octants;  ///< offsets of the arrays, one element an octant
    std::uint64_t valid, object_begin;                 ///< 1: all objects are valid boxes; first object
};

/// All lists of a pass. Each worker constructs the same SortedLists, so offsets agree, and makes some of the lists.
class SortedLists {
public:
    SortedLists(const EntrySource& source, Arena& arena, std::size_t lists, const std::stop_token& stop);

    /// Encodes and sorts the objects of list `list`. Throws: Error{cancelled}.
    void make(std::size_t list, const std::stop_token& stop);
    const SortedListHead* head(std::size_t list) const { return &heads_[list]; }

private:
    const EntrySource& source_;
    Arena& arena_;
    OctreeLayout layout_;
    std::vector<NumberedBlock> blocks_;
    BuildMemory memory_;
    std::vector<Buffer<CellEntry>> entries_;
    std::vector<Buffer<std::uint64_t>> begins_;  // of home entries and of ghosts, by octant
    Buffer<SortedListHead> heads_;
};

/// Number of objects and octants that a valid list must agree with.
struct ListBounds {
    std::uint64_t objects, octants;
};

/// Returns the list whose head is at offset `head`, after checking it.
/// Throws: Error{engine_failed} if the list is damaged; LinearOctree::Invalid if one of its objects is not a valid box.
SortedList find_list(SharedMemory& arena, std::uint64_t head, const ListBounds& bounds);

}  // namespace octopair
