#include "engine/mpi/ascending_pieces.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <vector>

#include "base/stop.hpp"
#include "engine/ascending.hpp"
#include "engine/mpi/even_cuts.hpp"

namespace octopair {

namespace {

constexpr unsigned most_bin_bits = 14;        // of rows, for the cuts
constexpr std::size_t share_pairs = 1 << 16;  // to sort

}  // namespace

void AscendingPieces::bring_together(PairList& found, PairList::Storage& piece, const std::stop_token& stop) {
    const unsigned row_bits = unsigned(std::bit_width(rows_));
    bin_shift_ = row_bits > most_bin_bits ? row_bits - most_bin_bits : 0;
    std::vector<std::uint64_t> bins;
    Agreement agreement(comm_);
    agreement.together([&] {
        bins.resize((rows_ >> bin_shift_) + 1, 0);
        count_rows(found, bins);
    });
    comm_.add_up(bins);
    const std::vector<std::size_t> cuts = even_cuts(bins, comm_.size());
    RankCounts to_each;
    agreement.together([&] { to_each = pack(found, cuts); });
    found.storage().reset();
    const Exchange counts = comm_.plan_exchange(std::move(to_each));
    agreement.together([&] { received_.resize_discard(counts.incoming()); });
    comm_.exchange(sent_.data(), received_.data(), counts);
    const auto row = [&](std::size_t cut) { return std::min<std::uint64_t>(rows_, std::uint64_t(cut) << bin_shift_); };
    const ObjectRange own{row(cuts[comm_.rank()]), row(cuts[comm_.rank() + 1])};
    agreement.together([&] { sort_received(piece, own, stop); });
}

void AscendingPieces::count_rows(const PairList& found, std::span<std::uint64_t> counts) const {
    for (const auto chunk : found.chunks()) {
        for (const Pair& pair : chunk) ++counts[bin(pair.a)];
    }
}

RankCounts AscendingPieces::pack(const PairList& found, std::span<const std::size_t> cuts) {
    std::vector<std::uint32_t> owners(cuts.back());
    for (unsigned rank = 0; rank < comm_.size(); ++rank) {
        std::fill(owners.begin() + std::ptrdiff_t(cuts[rank]), owners.begin() + std::ptrdiff_t(cuts[rank + 1]), rank);
    }
    RankCounts counts(comm_.size(), 0);
    for (const auto chunk : found.chunks()) {
        for (const Pair& pair : chunk) ++counts[owners[bin(pair.a)]];
    }
    sent_.resize_discard(std::size_t(found.size()));
    RankCounts places(comm_.size(), 0);
    std::exclusive_scan(counts.begin(), counts.end(), places.begin(), std::uint64_t(0));
    for (const auto chunk : found.chunks()) {
        for (const Pair& pair : chunk) sent_[std::size_t(places[owners[bin(pair.a)]]++)] = pair;
    }
    return counts;
}

void AscendingPieces::sort_received(PairList::Storage& piece, const ObjectRange& rows, const std::stop_token& stop) {
    const std::span<const Pair> all = received_.span();
    AscendingBounds bounds{rows, columns_};
    bounds.expected = all.size();
    AscendingExecutor executor(team_, piece, bounds);
    executor.for_each_writing((all.size() + share_pairs - 1) / share_pairs, [&](std::size_t i, PairWriter& writer) {
        throw_if_stopped(stop);
        const std::size_t begin = i * share_pairs;
        writer.write(all.subspan(begin, std::min(share_pairs, all.size() - begin)));
    });
    executor.append_sorted(stop);
}

}  // namespace octopair
