// SlottedRows, and the SIMD version of sort_group(), which Highway compiles for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "boxes/slotted_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <utility>

#include "boxes/simd_lanes-inl.hpp"
#include "boxes/slotted_rows.hpp"
#include "boxes/sorting_networks.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

void sort_group_simd(const RowGroup& group, Pair* out) { sort_group_scalar(group, out); }

#else

template <Exchange exchange>
HWY_INLINE void apply(Lanes* slots) {
    const auto less = hn::Min(slots[exchange.low], slots[exchange.high]);
    slots[exchange.high] = hn::Max(slots[exchange.low], slots[exchange.high]);
    slots[exchange.low] = less;
}

/// Sorts the slots of each lane's row. Unrolled, so that slots stay in registers.
template <std::size_t count, std::size_t... exchanges>
HWY_INLINE void sort_slots(Lanes* slots, std::index_sequence<exchanges...>) {
    (apply<sorting_network<count>[exchanges]>(slots), ...);
}

/// Writes the rows of a register's lanes. Their first `count` slots have all their pairs.
template <std::size_t count>
HWY_INLINE Pair* write_lanes(const RowGroup& group, std::size_t first_row, const Lanes& sizes, Pair* out) {
    const Words d;
    const hn::FixedTag<std::uint32_t, 4> four;
    constexpr std::size_t quads = count / 4;
    const std::uint32_t* const rows = group.slots + row_slots * first_row;
    Lanes slots[quads][4];
    for (std::size_t quad = 0; quad < quads; ++quad) {
        load_items(slots[quad], [&](std::size_t row) { return rows + row_slots * row + 4 * quad; });
        for (std::size_t i = 0; i < 4; ++i) {
            // Unused slots get the greatest number, which no object has.
            const auto used = hn::Gt(sizes, hn::Set(d, std::uint32_t(4 * quad + i)));
            slots[quad][i] = hn::IfThenElse(used, slots[quad][i], hn::Set(d, ~0u));
        }
    }
    sort_slots<count>(&slots[0][0], std::make_index_sequence<sorting_network<count>.size()>());
    alignas(64) std::uint32_t by_row[quads][max_lanes][4], row_sizes[max_lanes];
    for (std::size_t quad = 0; quad < quads; ++quad) {
        transpose(slots[quad]);
        for (std::size_t i = 0; i < 4; ++i) {
            store_blocks(d, slots[quad][i], i, [&](std::size_t row) { return by_row[quad][row]; });
        }
    }
    hn::Store(sizes, d, row_sizes);
    for (std::size_t row = 0; row < hn::Lanes(d); ++row) {
        // All slots are written. The next row overwrites those behind the last pair.
        const auto first = hn::Set(four, group.first_object + std::uint32_t(first_row + row));
        for (std::size_t quad = 0; quad < quads; ++quad) {
            const auto seconds = hn::Load(four, by_row[quad][row]);
            hn::StoreInterleaved2(first, seconds, four, reinterpret_cast<std::uint32_t*>(out + 4 * quad));
        }
        out += row_sizes[row];
    }
    return out;
}

void sort_group_simd(const RowGroup& group, Pair* out) {
    const Words d;
    const hn::Rebind<std::uint16_t, Words> halves;
    static_assert(row_group % max_lanes == 0);
    for (std::size_t row = 0; row < row_group; row += hn::Lanes(d)) {
        const auto all_sizes = hn::PromoteTo(d, hn::LoadU(halves, group.counts + row));
        const auto sizes = hn::IfThenElseZero(hn::Lt(all_sizes, hn::Set(d, std::uint32_t(row_slots + 1))), all_sizes);
        const std::uint32_t most = hn::GetLane(hn::MaxOfLanes(d, sizes));
        out = most <= 4   ? write_lanes<4>(group, row, sizes, out)
              : most <= 8 ? write_lanes<8>(group, row, sizes, out)
                          : write_lanes<16>(group, row, sizes, out);
    }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(sort_group_simd);

void sort_group(const RowGroup& group, Pair* out) { HWY_DYNAMIC_DISPATCH(sort_group_simd)(group, out); }

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

#endif  // HWY_ONCE
