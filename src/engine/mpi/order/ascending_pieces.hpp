// AscendingPieces: pairs that ranks have found in any order, brought into one ascending sequence over all ranks.
//
// The objects of `a` are cut into pieces with about equally many pairs, for each rank as many as it takes windows; pairs go to
// the rank of their `a`, which sorts them, window after window. Where each rank keeps its pairs, its pieces are neighbours;
// where they go on to rank 0, the pieces of a window are.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "base/memory.hpp"
#include "engine/ascending_bounds.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/order/row_bins.hpp"
#include "engine/pair_list.hpp"
#include "parallel/team.hpp"

namespace octopair {

/// How pieces are shared out.
struct PieceGrid {
    unsigned ranks = 1, windows = 1;
    bool by_window = false;  ///< neighbours are those of a window, rather than those of a rank

    std::size_t size() const { return std::size_t(ranks) * windows; }
    unsigned rank(std::size_t piece) const { return unsigned(by_window ? piece % ranks : piece / windows); }
    unsigned window(std::size_t piece) const { return unsigned(by_window ? piece / ranks : piece % windows); }
    std::size_t piece(unsigned of_rank, unsigned in_window) const {
        return by_window ? std::size_t(in_window) * ranks + of_rank : std::size_t(of_rank) * windows + in_window;
    }
};

/// Which pairs are which rank's, and in which window. The same on all ranks.
class PiecePlan {
public:
    /// `counts`: of all ranks' pairs, by bin.
    PiecePlan(const RowBins& bins, std::span<const std::uint64_t> counts, const PieceGrid& grid);

    const RowBins& bins() const { return bins_; }
    unsigned windows() const { return grid_.windows; }
    unsigned owner(const Pair& pair) const { return grid_.rank(pieces_[bins_.bin(pair)]); }
    /// The objects whose pairs are a rank's in a window.
    ObjectRange rows(unsigned rank, unsigned window) const;
    /// Of all its windows.
    std::uint64_t pairs(unsigned rank) const;
    /// Of a window of a rank, how many pairs are among the first `limit` of all.
    std::uint64_t allowed(unsigned rank, unsigned window, std::uint64_t limit) const;
    /// Whether any rank's part of a window has such.
    bool is_wanted(unsigned window, std::uint64_t limit) const;
    /// The bins of a window, of all ranks.
    std::vector<std::uint8_t> marks(unsigned window) const;

private:
    RowBins bins_;
    PieceGrid grid_;
    std::vector<std::size_t> cuts_;      // of the bins: where each piece begins, and the end
    std::vector<std::uint32_t> pieces_;  // of each bin
    std::vector<std::uint64_t> before_;  // pairs before each piece, and all
};

class AscendingPieces {
public:
    /// `columns`: above every `b`.
    AscendingPieces(Communicator& comm, Team& team, std::uint64_t columns)
        : comm_(comm), team_(team), columns_(columns) {}

    /// Collective: by what all ranks have found.
    PiecePlan plan(const PairList& found, const RowBins& bins);
    /// Collective: appends this rank's pairs of a window, of what all ranks found of it, to `piece`. Empties `found`. Throws
    /// as Agreement::together.
    void bring_together(PairList& found, const PiecePlan& plan, unsigned window, detail::PairStorage& piece,
                        const std::stop_token& stop);

private:
    RankCounts pack(const PairList& found, const PiecePlan& plan);
    void sort_received(detail::PairStorage& piece, const ObjectRange& rows, const std::stop_token& stop);

    Communicator& comm_;
    Team& team_;
    std::uint64_t columns_;
    Buffer<Pair> sent_, received_;
};

}  // namespace octopair
