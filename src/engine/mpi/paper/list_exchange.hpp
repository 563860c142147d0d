// ListExchange: sorted lists of several ranks, brought to one that is to merge them.
//
// A list travels as its entries and, of each octant, how many are home and how many are not.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "octopair/mpi.hpp"
#include "octree/build/sorted_list.hpp"

namespace octopair {

class ListExchange {
public:
    /// `costs`: packing and unpacking adds to these. Borrows both.
    ListExchange(Communicator& comm, RankCosts& costs) : comm_(comm), costs_(costs) {}

    /// Collective: this rank's list goes to a rank, or nowhere if that is itself. Returns those that came, in the order of the
    /// ranks; kept until the next call. All lists are of as many octants. Throws as Agreement::together.
    std::vector<SortedList> bring(const SortedList& own, unsigned to);

private:
    void pack(const SortedList& list);
    std::vector<SortedList> unpack(std::size_t octants);

    Communicator& comm_;
    RankCosts& costs_;
    Buffer<std::uint32_t> sent_counts_, received_counts_;
    Buffer<Entry> received_;
    Buffer<std::uint64_t> begins_;
};

}  // namespace octopair
