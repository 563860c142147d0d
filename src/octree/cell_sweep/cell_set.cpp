#include "octree/cell_sweep/cell_set.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/memory.hpp"
#include "base/tuning.hpp"

namespace octopair {

CellColumn column_of(const CellEntry& entry) {
    constexpr unsigned dropped_bits = cell_bits - 8;
    const auto bytes = [&](unsigned k) {
        return entry.low(k) >> dropped_bits | (entry.high(k) >> dropped_bits ^ 0xFFu) << 8;
    };
    return {entry.low(0) | (entry.high(0) ^ 0xFFFFu) << 16, bytes(1) | bytes(2) << 16};
}

namespace {

/// Prefetches runs of entries, a cache line at a time.
class Prefetcher {
public:
    explicit Prefetcher(CellSet::Runs runs) : runs_(runs) {}
    void fetch_line() {
        if (at_ == end_) {
            if (runs_.empty()) return;
            at_ = runs_.front().data();
            end_ = at_ + runs_.front().size();
            runs_ = runs_.subspan(1);
        }
        prefetch(at_);
        constexpr std::ptrdiff_t line = 64 / sizeof(CellEntry);
        at_ += std::min(line, end_ - at_);
    }

private:
    CellSet::Runs runs_;
    const CellEntry *at_ = nullptr, *end_ = nullptr;
};

}  // namespace

void CellSet::turn() {
    turned_.assign(entries_.data(), entries_.data() + size_);
    for (CellEntry& entry : turned_) std::ranges::rotate(entry.ends, entry.ends.begin() + 1);
    const std::span<const CellEntry> run = turned_;
    assign({&run, 1});
}

void CellSet::assign(Runs runs, Runs next) {
    size_ = 0;
    for (const auto run : runs) size_ += run.size();
    entries_.resize_discard(size_ + 1);
    first_axis_.resize_discard(size_ + padding);
    other_axes_.resize_discard(size_ + padding);
    buckets_.resize(size_);
    const unsigned max_bits = unsigned(std::bit_width(tuning().sweep.max_cell_buckets)) - 1;
    const unsigned bits = std::min({cell_bits, max_bits, unsigned(std::bit_width(size_ / 2))});
    bucket_shift_ = cell_bits - bits;
    bucket_ends_.assign(std::size_t(1) << bits, 0);
    Prefetcher prefetcher(next);
    std::uint16_t* bucket = buckets_.data();
    for (const auto run : runs) {
        for (std::size_t i = 0; i < run.size(); ++i, ++bucket) {
            if (i % 4 == 0) prefetcher.fetch_line();
            *bucket = std::uint16_t(run[i].low(0) >> bucket_shift_);
            ++bucket_ends_[*bucket];
        }
    }
    std::uint32_t begin = 0;
    for (std::uint32_t& end : bucket_ends_) begin += std::exchange(end, begin);
    bucket = buckets_.data();
    for (const auto run : runs) {
        place_entries(run, {bucket, bucket_ends_.data(), entries_.data(), first_axis_.data(), other_axes_.data()});
        bucket += run.size();
    }
    std::fill_n(first_axis_.data() + size_, padding, ~0u);
    std::fill_n(other_axes_.data() + size_, padding, 0u);
}

}  // namespace octopair
