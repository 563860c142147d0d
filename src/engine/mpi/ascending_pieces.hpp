// AscendingPieces: pairs that ranks have found in any order, brought into one ascending sequence over all ranks.
//
// The objects of `a` are cut into runs with about equally many pairs, one for each rank; pairs go to the rank of their `a`,
// which sorts them.
#pragma once

#include <cstdint>
#include <stop_token>

#include "base/memory.hpp"
#include "engine/ascending_bounds.hpp"
#include "engine/mpi/agreement.hpp"
#include "engine/mpi/communicator.hpp"
#include "engine/pair_list.hpp"
#include "parallel/team.hpp"

namespace octopair {

class AscendingPieces {
public:
    /// `rows`: above every `a`; `columns`: above every `b`.
    AscendingPieces(Communicator& comm, Team& team, std::uint64_t rows, std::uint64_t columns)
        : comm_(comm), team_(team), rows_(rows), columns_(columns) {}

    /// Collective: appends this rank's piece of what all ranks found to `piece`. Empties `found`. Throws as
    /// Agreement::together.
    void bring_together(PairList& found, PairList::Storage& piece, const std::stop_token& stop);

private:
    void count_rows(const PairList& found, std::span<std::uint64_t> counts) const;
    RankCounts pack(const PairList& found, std::span<const std::size_t> cuts);
    void sort_received(PairList::Storage& piece, const ObjectRange& rows, const std::stop_token& stop);
    std::uint64_t bin(std::uint32_t a) const { return a >> bin_shift_; }

    Communicator& comm_;
    Team& team_;
    std::uint64_t rows_, columns_;
    unsigned bin_shift_ = 0;
    Buffer<Pair> sent_, received_;
};

}  // namespace octopair
