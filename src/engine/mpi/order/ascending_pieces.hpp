// AscendingPieces: sorts the pairs that ranks found in any order into one ascending sequence over all ranks.
//
// Invariants 1. The objects `a` are divided into pieces with about equally many pairs: one piece for each rank and window.
//            2. Each pair is sent to the rank that owns the piece of its `a`. That rank sorts it, window after window.
//            3. If each rank keeps its pairs, the pieces of a rank are adjacent in the sequence. If the pairs are sent on to
//               rank 0, the pieces of a window are adjacent.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "base/memory.hpp"
#include "base/tuning.hpp"
#include "engine/bucket_sort.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/pair_list.hpp"
#include "octopair/objects.hpp"
#include "parallel/team.hpp"

namespace octopair {

/// Bins of consecutive objects. Pairs are counted, and assigned to ranks, by the bin of their `a`.
class RowBins {
public:
    explicit RowBins(std::uint64_t rows) : rows_(rows) {
        const unsigned bits = unsigned(std::bit_width(rows)), max_bits = tuning().ranks.row_bin_bits;
        shift_ = bits > max_bits ? bits - max_bits : 0;
    }

    std::size_t size() const { return std::size_t(rows_ >> shift_) + 1; }
    std::size_t bin(const Pair& pair) const { return pair.a >> shift_; }
    /// Returns the number of low bits of `a` in which the objects of a bin differ.
    unsigned shift() const { return shift_; }
    /// Returns the first object of a bin, or the number of objects if there is none.
    std::uint64_t begin(std::size_t bin) const {
        const std::uint64_t row = std::uint64_t(bin) << shift_;
        return row < rows_ ? row : rows_;
    }

private:
    std::uint64_t rows_;
    unsigned shift_;
};

/// Selection of pairs: those whose bin has a nonzero mark. Borrows the marks.
struct WantedRows {
    RowBins bins{0};
    std::span<const std::uint8_t> marks = {};  ///< by bin; empty: all pairs are wanted
};

/// Numbering of the pieces, in ascending order of their objects.
struct PieceGrid {
    unsigned ranks = 1, windows = 1;
    bool by_window = false;  ///< true: the pieces of a window are adjacent; false: the pieces of a rank are adjacent

    std::size_t size() const { return std::size_t(ranks) * windows; }
    unsigned rank(std::size_t piece) const { return unsigned(by_window ? piece % ranks : piece / windows); }
    unsigned window(std::size_t piece) const { return unsigned(by_window ? piece / ranks : piece % windows); }
    std::size_t piece(unsigned of_rank, unsigned in_window) const {
        return by_window ? std::size_t(in_window) * ranks + of_rank : std::size_t(of_rank) * windows + in_window;
    }
};

/// Assignment of pairs to ranks and windows. The same on all ranks.
class PiecePlan {
public:
    /// `counts`: number of pairs of each bin, on all ranks together.
    PiecePlan(const RowBins& bins, std::span<const std::uint64_t> counts, const PieceGrid& grid);

    const RowBins& bins() const { return bins_; }
    unsigned windows() const { return grid_.windows; }
    unsigned owner(const Pair& pair) const { return grid_.rank(pieces_[bins_.bin(pair)]); }
    /// Returns the objects `a` of a rank's piece of a window.
    ObjectRange rows(unsigned rank, unsigned window) const;
    /// Returns the number of pairs of a rank, in all its windows.
    std::uint64_t pairs(unsigned rank) const;
    /// Returns how many pairs of a rank's piece of a window are among the first `limit` pairs of the sequence.
    std::uint64_t allowed(unsigned rank, unsigned window, std::uint64_t limit) const;
    /// Returns whether a window has pairs, on any rank, among the first `limit` pairs of the sequence.
    bool is_wanted(unsigned window, std::uint64_t limit) const;
    /// Returns a mark for each bin: nonzero if the bin belongs to the window, on any rank.
    std::vector<std::uint8_t> marks(unsigned window) const;

private:
    RowBins bins_;
    PieceGrid grid_;
    std::vector<std::size_t> cuts_;      // first bin of each piece, then the number of bins
    std::vector<std::uint32_t> pieces_;  // piece of each bin
    std::vector<std::uint64_t> before_;  // number of pairs before each piece, then the number of all pairs
};

class AscendingPieces {
public:
    /// `columns`: exclusive upper bound of every `b`. `on_sorted`: any thread calls it with numbers of sorted pairs; may be
    /// empty. Borrows `comm` and `team`.
    AscendingPieces(Communicator& comm, Team& team, std::uint64_t columns,
                    std::function<void(std::uint64_t)> on_sorted = {})
        : comm_(comm), team_(team), columns_(columns), on_sorted_(std::move(on_sorted)) {}

    /// Collective. Returns a plan with one window for the pairs that all ranks found. `found`: those of this rank.
    PiecePlan plan(const PairList& found, const RowBins& bins);
    /// Collective. Sends the pairs of `found`, which all belong to `window`, to their ranks; empties `found`. Appends the pairs
    /// of this rank's piece of the window to `piece`, ascending. Throws: as Agreement::together.
    void exchange_and_sort(PairList& found, const PiecePlan& plan, unsigned window, detail::PairStorage& piece,
                           const std::stop_token& stop);

private:
    RankCounts pack(const PairList& found, const PiecePlan& plan);
    void sort_received(detail::PairStorage& piece, const ObjectRange& rows, const std::stop_token& stop);

    Communicator& comm_;
    Team& team_;
    std::uint64_t columns_;
    std::function<void(std::uint64_t)> on_sorted_;
    Buffer<Pair> sent_, received_;
};

}  // namespace octopair
