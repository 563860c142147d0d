#include "octree/sweep/cell_set.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/memory.hpp"
#include "base/tuning.hpp"

namespace octopair {

std::array<std::uint8_t, cell_planes> plane_bytes(const CellEntry& entry) {
    constexpr unsigned dropped_bits = cell_bits - 8;
    const auto byte = [](std::uint32_t cell) { return std::uint8_t(cell >> dropped_bits); };
    return {byte(entry.low(1)), byte(entry.high(1)), byte(entry.low(2)), byte(entry.high(2))};
}

void CellSet::turn() {
    turned_.assign(entries_.data(), entries_.data() + size_);
    for (CellEntry& entry : turned_) std::ranges::rotate(entry.ends, entry.ends.begin() + 1);
    const std::span<const CellEntry> run = turned_;
    assign({&run, 1});
}

void CellSet::assign(Runs runs) {
    size_ = 0;  // until all memory is allocated
    has_planes_ = false;
    std::size_t size = 0;
    for (const auto run : runs) size += run.size();
    entries_.resize_discard(size + entries_read_beyond);
    buckets_.resize(size);
    const unsigned max_bits = unsigned(std::bit_width(tuning().sweep.max_cell_buckets)) - 1;
    const unsigned bits = std::min({cell_bits, max_bits, unsigned(std::bit_width(size / 2))});
    bucket_shift_ = cell_bits - bits;
    bucket_begins_.assign((std::size_t(1) << bits) + 1, 0);
    size_ = size;
    const std::span<std::uint32_t> ends = std::span(bucket_begins_).subspan(1);
    std::uint16_t* bucket = buckets_.data();
    for (const auto run : runs) {
        for (const CellEntry& entry : run) {
            *bucket = std::uint16_t(entry.low(0) >> bucket_shift_);
            ++ends[*bucket++];
        }
    }
    std::uint32_t begin = 0;
    for (std::uint32_t& end : ends) begin += std::exchange(end, begin);
    bucket = buckets_.data();
    for (const auto run : runs) {
        for (const CellEntry& entry : run) entries_[ends[*bucket++]++] = entry;
    }
    std::fill_n(entries_.data() + size_, entries_read_beyond, CellEntry{{last_octant_cell << 16, 0, 0}, 0});
}

void CellSet::make_planes() {
    if (has_planes_) return;
    stride_ = size_ + bytes_read_beyond;
    planes_.resize_discard(cell_planes * stride_);
    write_planes({entries_.data(), size_}, planes_.data(), stride_);
    has_planes_ = true;
}

}  // namespace octopair
