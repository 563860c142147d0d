#include "boxes/slotted_rows.hpp"

#include <algorithm>

namespace octopair {

void sort_group_scalar(const RowGroup& group, Pair* out) {
    for (std::size_t row = 0; row < row_group; ++row) {
        const std::size_t size = group.counts[row];
        if (size > row_slots) continue;
        std::array<std::uint32_t, row_slots> seconds;
        std::copy_n(group.slots + row_slots * row, size, seconds.begin());
        std::sort(seconds.begin(), seconds.begin() + std::ptrdiff_t(size));
        for (std::size_t i = 0; i < size; ++i) *out++ = {group.first_object + std::uint32_t(row), seconds[i]};
    }
}

void SlottedRows::reset(std::size_t rows, std::size_t pairs, std::uint32_t first_object) {
    rows_ = rows;
    first_object_ = first_object;
    const std::size_t whole_groups = (rows + row_group - 1) / row_group * row_group;
    slots_.resize_discard(whole_groups * row_slots);
    counts_.assign(whole_groups, 0);
    spilled_.resize_discard(pairs);
    spilled_size_ = 0;
}

void SlottedRows::add(std::span<const Pair> pairs, std::span<const Pair> next) {
    constexpr std::size_t line = 64 / sizeof(Pair);
    std::uint32_t* const slots = slots_.data();
    std::uint16_t* const counts = counts_.data();
    std::uint64_t* spilled = spilled_.data() + spilled_size_;
    const std::uint32_t first_object = first_object_, row_bits = std::uint32_t(rows_ - 1);
    for (std::size_t begin = 0; begin < pairs.size(); begin += line) {
        if (begin < next.size()) prefetch(next.data() + begin);
        for (const Pair& pair : pairs.subspan(begin, std::min(line, pairs.size() - begin))) {
            const std::size_t row = (pair.a - first_object) & row_bits;
            const std::size_t slot = counts[row]++;
            if (slot < row_slots) [[likely]] {
                slots[row_slots * row + slot] = pair.b;
            } else {
                *spilled++ = std::uint64_t(row) << 32 | pair.b;
            }
        }
    }
    spilled_size_ = std::size_t(spilled - spilled_.data());
}

void SlottedRows::collect_long_rows() {
    if (spilled_size_ == 0) return;
    long_ends_.resize(rows_);
    std::uint32_t end = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
        long_ends_[row] = end;
        if (is_long(row)) end += std::uint32_t(size(row));
    }
    long_rows_.resize_discard(end + read_beyond);
    for (const std::uint64_t pair : spilled_.span().first(spilled_size_)) {
        long_rows_[long_ends_[pair >> 32]++] = std::uint32_t(pair);
    }
    for (std::size_t row = 0; row < rows_; ++row) {
        for (std::size_t slot = 0; is_long(row) && slot < row_slots; ++slot) {
            long_rows_[long_ends_[row]++] = slots_[row_slots * row + slot];
        }
    }
}

std::span<const std::uint32_t> SlottedRows::long_row(std::size_t row) const {
    return long_rows_.span().subspan(long_ends_[row] - size(row), size(row));
}

}  // namespace octopair
