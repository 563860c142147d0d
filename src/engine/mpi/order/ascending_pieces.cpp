#include "engine/mpi/order/ascending_pieces.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "base/stop.hpp"
#include "base/tuning.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/partition/even_cuts.hpp"
#include "engine/threads/team_output.hpp"

namespace octopair {

PiecePlan::PiecePlan(const RowBins& bins, std::span<const std::uint64_t> counts, const PieceGrid& grid)
    : bins_(bins),
      grid_(grid),
      cuts_(even_cuts(counts, grid.size())),
      pieces_(counts.size()),
      before_(grid.size() + 1) {
    for (std::uint32_t piece = 0; piece + 1 < cuts_.size(); ++piece) {
        before_[piece + 1] = before_[piece];
        for (std::size_t bin = cuts_[piece]; bin < cuts_[piece + 1]; ++bin) {
            pieces_[bin] = piece;
            before_[piece + 1] += counts[bin];
        }
    }
}

ObjectRange PiecePlan::rows(unsigned rank, unsigned window) const {
    const std::size_t piece = grid_.piece(rank, window);
    return {bins_.begin(cuts_[piece]), bins_.begin(cuts_[piece + 1])};
}

std::uint64_t PiecePlan::allowed(unsigned rank, unsigned window, std::uint64_t limit) const {
    const std::size_t piece = grid_.piece(rank, window);
    return std::min(limit, before_[piece + 1]) - std::min(limit, before_[piece]);
}

std::uint64_t PiecePlan::pairs(unsigned rank) const {
    std::uint64_t sum = 0;
    for (unsigned window = 0; window < grid_.windows; ++window) sum += allowed(rank, window, before_.back());
    return sum;
}

bool PiecePlan::is_wanted(unsigned window, std::uint64_t limit) const {
    for (unsigned rank = 0; rank < grid_.ranks; ++rank) {
        if (allowed(rank, window, limit) > 0) return true;
    }
    return false;
}

std::vector<std::uint8_t> PiecePlan::marks(unsigned window) const {
    std::vector<std::uint8_t> marks(pieces_.size());
    std::ranges::transform(pieces_, marks.begin(), [&](std::uint32_t piece) { return grid_.window(piece) == window; });
    return marks;
}

PiecePlan AscendingPieces::plan(const PairList& found, const RowBins& bins) {
    std::vector<std::uint64_t> counts;
    Agreement(comm_).together([&] {
        counts.resize(bins.size(), 0);
        for (const auto chunk : found.chunks()) {
            for (const Pair& pair : chunk) ++counts[bins.bin(pair)];
        }
    });
    comm_.add_up(counts);
    return {bins, counts, {.ranks = comm_.size()}};
}

// NOLINTNEXTLINE(readability-function-size): pairs, plan, window, output, stop.
void AscendingPieces::exchange_and_sort(PairList& found, const PiecePlan& plan, unsigned window,
                                        detail::PairStorage& piece, const std::stop_token& stop) {
    Agreement agreement(comm_);
    RankCounts to_each;
    agreement.together([&] { to_each = pack(found, plan); });
    detail::storage_of(found).reset();
    const Exchange counts = comm_.plan_exchange(std::move(to_each));
    agreement.together([&] { received_.resize_discard(counts.incoming()); });
    comm_.exchange(sent_.data(), received_.data(), counts);
    agreement.together([&] { sort_received(piece, plan.rows(comm_.rank(), window), stop); });
}

RankCounts AscendingPieces::pack(const PairList& found, const PiecePlan& plan) {
    RankCounts counts(comm_.size(), 0);
    for (const auto chunk : found.chunks()) {
        for (const Pair& pair : chunk) ++counts[plan.owner(pair)];
    }
    sent_.resize_discard(std::size_t(found.size()));
    RankCounts places(comm_.size(), 0);
    std::exclusive_scan(counts.begin(), counts.end(), places.begin(), std::uint64_t(0));
    for (const auto chunk : found.chunks()) {
        for (const Pair& pair : chunk) sent_[std::size_t(places[plan.owner(pair)]++)] = pair;
    }
    return counts;
}

void AscendingPieces::sort_received(detail::PairStorage& piece, const ObjectRange& rows, const std::stop_token& stop) {
    const std::span<const Pair> all = received_.span();
    AscendingBounds bounds{rows, columns_};
    bounds.expected = all.size();
    const std::size_t share_pairs = tuning().ranks.share_pairs;
    const auto write_received = [&](Executor& executor) {
        executor.for_each_writing((all.size() + share_pairs - 1) / share_pairs,
                                  [&](std::size_t i, ShareWriter& writer) {
                                      throw_if_stopped(stop);
                                      const std::size_t begin = i * share_pairs;
                                      writer.write(all.subspan(begin, std::min(share_pairs, all.size() - begin)));
                                  });
    };
    list_ascending_pairs(team_, piece, bounds, write_received, {.stop = stop, .sorted = on_sorted_});
}

}  // namespace octopair
