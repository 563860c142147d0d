// Sorted lists of the ranks in the paper's arrangement. ListMaker makes the list of a rank's objects. ListExchange sends lists
// of several ranks to the rank that merges them.
//
// A list is sent as its entries and two counts for each octant: the number of home entries and the number of ghosts.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "octopair/mpi.hpp"
#include "octree/build/sorted_list.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

class ListMaker {
public:
    /// Encodes and sorts the objects of a source. Returns their list, whose memory stays valid until the next call.
    /// `first_object`: number of the first object among the objects of all ranks.
    /// Throws: Error{cancelled}; LinearOctree::Invalid.
    SortedList make(const EntrySource& source, const OctreeLayout& layout, std::uint32_t first_object,
                    const std::stop_token& stop);

private:
    BuildMemory memory_{own_pages()};
    Buffer<CellEntry> entries_;
    Buffer<std::uint64_t> begins_;  // of home entries and of ghosts, by octant
};

class ListExchange {
public:
    /// Borrows both. Adds the time of packing and unpacking to `costs`.
    ListExchange(Communicator& comm, RankCosts& costs) : comm_(comm), costs_(costs) {}

    /// Collective. Sends this rank's list to rank `to`; sends nothing if `to` is this rank. Returns the received lists, in rank
    /// order; their memory stays valid until the next call. Requires: all lists have the same number of octants.
    /// Throws: as Agreement::together.
    std::vector<SortedList> exchange(const SortedList& own, unsigned to);

private:
    void pack(const SortedList& list);
    std::vector<SortedList> unpack(std::size_t octants);

    Communicator& comm_;
    RankCosts& costs_;
    Buffer<std::uint32_t> sent_counts_, received_counts_;
    Buffer<CellEntry> received_;
    Buffer<std::uint64_t> begins_;
};

}  // namespace octopair
