// SIMD versions of the functions of box_sweep.hpp. Highway compiles them for each instruction set; one is chosen at run time.
//
// A register of columns is tested against the rows of a block, one row after another. The number of columns differs from row to row, so
// the processor mispredicts the end of a loop over columns. With blocks of 8 rows, this happens at most once for 8 rows.
// Hits are queued as masks, without a branch on whether there are any. Dense scenes mispredict that branch: writing the pairs
// separately from the sweep was 1.5 times faster there.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/sweep/box_sweep_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "boxes/simd_lanes-inl.hpp"
#include "octree/sweep/box_sweep.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t row_block = BoxSweep::row_block, column_group = BoxSweep::column_group;

/// Pointers to the bounds of a set, from box `first` on: on the sweep's axis (0) and on the two other axes (1, 2).
struct Bounds {
    Bounds(const BoxSet& set, std::size_t first)
        : low0(set.low(0) + first),
          low1(set.low(1) + first),
          low2(set.low(2) + first),
          high0(set.high(0) + first),
          high1(set.high(1) + first),
          high2(set.high(2) + first) {}
    const float *low0, *low1, *low2, *high0, *high1, *high2;
};

/// Bounds of the columns in a register.
template <typename D>
struct Columns {
    using V = hn::Vec<D>;
    Columns(D d, const Bounds& from)
        : low0(hn::LoadU(d, from.low0)),
          low1(hn::LoadU(d, from.low1)),
          low2(hn::LoadU(d, from.low2)),
          high1(hn::LoadU(d, from.high1)),
          high2(hn::LoadU(d, from.high2)) {}
    V low0, low1, low2, high1, high2;
};

/// Sets bit `row` of each column that overlaps this row of a block and begins where the kind of sweep requires.
template <SweepKind kind, typename D, typename V>
HWY_INLINE V test_row(const Bounds& rows, std::size_t row, const Columns<D>& columns, V bits) {
    const D d;
    const hn::RebindToUnsigned<D> words;
    auto on0 = hn::Le(columns.low0, hn::Set(d, rows.high0[row]));
    if constexpr (kind == SweepKind::cross) on0 = hn::And(on0, hn::Ge(columns.low0, hn::Set(d, rows.low0[row])));
    if constexpr (kind == SweepKind::cross_strict) on0 = hn::And(on0, hn::Gt(columns.low0, hn::Set(d, rows.low0[row])));
    const auto on1 =
        hn::And(hn::Le(columns.low1, hn::Set(d, rows.high1[row])), hn::Ge(columns.high1, hn::Set(d, rows.low1[row])));
    const auto on2 =
        hn::And(hn::Le(columns.low2, hn::Set(d, rows.high2[row])), hn::Ge(columns.high2, hn::Set(d, rows.low2[row])));
    const auto hit = hn::VecFromMask(d, hn::And(on0, hn::And(on1, on2)));
    return hn::Or(bits, hn::And(hn::BitCast(words, hit), hn::Set(words, 1u << row)));
}

/// Writes a mask for each column with a hit. Returns the number of masks.
template <typename D, typename V>
HWY_INLINE std::size_t queue_hits(D d, V columns, V rows, BoxHits* hits) {
    const hn::Rebind<std::uint8_t, D> bytes;
    const auto hit = hn::Ne(hn::And(rows, hn::Set(d, (1u << row_block) - 1)), hn::Zero(d));
    const std::uint32_t set = bits_of(d, hit);
    const auto lanes = hn::IndicesFromVec(d, hn::PromoteTo(d, hn::LoadU(bytes, lanes_in.of[set].data())));
    // All lanes are stored. The next store overwrites the lanes beyond the hits.
    hn::StoreInterleaved2(hn::TableLookupLanes(columns, lanes), hn::TableLookupLanes(rows, lanes), d,
                          reinterpret_cast<std::uint32_t*>(hits));
    return lanes_in.count[set];
}

/// Clears the rows that share a bit of their mask with the column, and removes empty masks. Returns the number of masks left.
std::size_t drop_shared(const BoxSweep& sweep, std::span<BoxHits> hits) {
    const hn::CappedTag<std::uint32_t, row_block> d;
    BoxHits* at = hits.data();
    for (const BoxHits hit : hits) {
        const auto column = hn::Set(d, sweep.columns.mask()[hit.column()]);
        const std::uint32_t* const rows = sweep.rows.mask() + hit.first_row();
        std::uint32_t apart = 0;
        for (std::size_t lane = 0; lane < row_block; lane += hn::Lanes(d)) {
            apart |= bits_of(d, hn::Eq(hn::And(column, hn::LoadU(d, rows + lane)), hn::Zero(d))) << lane;
        }
        const std::uint32_t bits = hit.bits() & apart;
        *at = BoxHits(hit.column(), hit.first_row(), bits);
        at += std::size_t(bits != 0);
    }
    return std::size_t(at - hits.data());
}

/// Maximum high ends of a block of rows on the sweep's axis.
struct Reach {
    float most;         ///< maximum over the rows that are not far
    float all;          ///< maximum over all rows
    std::uint32_t far;  ///< bit mask of the rows that reach more than twice as far as the mean: at most 3 of 8
};

template <typename D>
HWY_INLINE Reach reach_of(D d, const Bounds& rows) {
    constexpr float none = -std::numeric_limits<float>::infinity();
    const auto begin = hn::Set(d, rows.low0[0]);
    auto sum = hn::Zero(d);
    for (std::size_t lane = 0; lane < row_block; lane += hn::Lanes(d)) {
        sum = hn::Add(sum, hn::Max(hn::Sub(hn::LoadU(d, rows.high0 + lane), begin), hn::Zero(d)));
    }
    const auto twice_mean = hn::Mul(hn::SumOfLanes(d, sum), hn::Set(d, 2.0f / row_block));
    auto most = hn::Set(d, none), all = most;
    Reach reach{};
    for (std::size_t lane = 0; lane < row_block; lane += hn::Lanes(d)) {
        const auto highs = hn::LoadU(d, rows.high0 + lane);
        const auto far = hn::Gt(hn::Sub(highs, begin), twice_mean);
        reach.far |= bits_of(d, far) << lane;
        most = hn::Max(most, hn::IfThenElse(far, hn::Set(d, none), highs));
        all = hn::Max(all, highs);
    }
    reach.most = hn::GetLane(hn::MaxOfLanes(d, most));
    reach.all = hn::GetLane(hn::MaxOfLanes(d, all));
    if (planted(Fault::window_end_open)) {
        for (float* const end : {&reach.most, &reach.all}) *end = std::nextafter(*end, none);
    }
    return reach;
}

/// For column k of the block itself: bit mask of the rows before the column.
constexpr std::array<std::uint32_t, row_block> rows_before = {0x00, 0x01, 0x03, 0x07, 0x0F, 0x1F, 0x3F, 0x7F};

template <SweepKind kind>
std::size_t find_hits_of(const BoxSweep& sweep, BoxCursor& cursor, std::span<BoxHits> hits) {
    if (cursor.row >= sweep.rows.size()) return 0;
    const hn::CappedTag<float, column_group> d;
    const hn::RebindToUnsigned<decltype(d)> words;
    const float* const low0 = sweep.columns.low(0);
    const auto lane_numbers = hn::Iota(words, 0);
    BoxHits* hit_at = hits.data();
    BoxHits* const hits_end = hits.data() + (hits.size() - column_group);
    std::size_t tests_left = tuning().sweep.tests_per_call;
    Reach next = reach_of(d, Bounds(sweep.rows, cursor.row));
    for (; cursor.row < sweep.rows.size(); cursor.row += row_block, cursor.in_row = false) {
        start_rows(sweep, cursor);
        const std::uint32_t row = std::uint32_t(cursor.row);
        const Bounds rows(sweep.rows, row);
        const Reach reach = next;
        next = reach_of(d, Bounds(sweep.rows, row + row_block));  // started early because of its latency
        const auto block = hn::Set(words, row << row_block);
        const auto queue = [&](auto bits, std::size_t column) HWY_ATTR {
            if (kind == SweepKind::self && column < row + row_block) {
                bits = hn::And(bits, hn::LoadU(words, rows_before.data() + (column - row)));
            }
            hit_at += queue_hits(words, hn::Add(lane_numbers, hn::Set(words, std::uint32_t(column))),
                                 hn::Or(bits, block), hit_at);
        };
        std::size_t column = cursor.column;
        // The NaN of the padding ends both loops at the end of the set.
        for (; low0[column] <= reach.most && hit_at <= hits_end && tests_left > 0; column += hn::Lanes(d)) {
            const Columns columns(d, Bounds(sweep.columns, column));
            auto bits = hn::Zero(words);
            for (std::size_t i = 0; i < row_block; ++i) bits = test_row<kind>(rows, i, columns, bits);
            queue(bits, column);
            --tests_left;
        }
        for (; low0[column] <= reach.all && hit_at <= hits_end && tests_left > 0; column += hn::Lanes(d)) {
            const Columns columns(d, Bounds(sweep.columns, column));
            auto bits = hn::Zero(words);
            for (std::uint32_t far = reach.far; far != 0; far &= far - 1) {
                bits = test_row<kind>(rows, unsigned(std::countr_zero(far)), columns, bits);
            }
            --tests_left;
            if (!hn::AllTrue(words, hn::Eq(bits, hn::Zero(words)))) queue(bits, column);  // rare
        }
        if (low0[column] <= reach.all) {
            cursor.column = column;
            break;
        }
    }
    return drop_shared(sweep, {hits.data(), hit_at});
}

std::size_t find_hits_simd(const BoxSweep& sweep, BoxCursor& cursor, std::span<BoxHits> hits) {
    switch (sweep.kind) {
        case SweepKind::self:
            return find_hits_of<SweepKind::self>(sweep, cursor, hits);
        case SweepKind::cross:
            return find_hits_of<SweepKind::cross>(sweep, cursor, hits);
        default:
            return find_hits_of<SweepKind::cross_strict>(sweep, cursor, hits);
    }
}

std::size_t write_pairs_simd(const BoxSweep& sweep, std::span<const BoxHits> hits, std::uint32_t second_begin,
                             Pair* pairs) {
    const hn::CappedTag<std::uint32_t, LaneTable::lanes> d;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const auto offset = hn::Set(d, second_begin);
    const std::uint32_t* const rows = sweep.rows.object();
    const std::uint32_t* const columns = sweep.columns.object();
    std::uint32_t* const begin = reinterpret_cast<std::uint32_t*>(pairs);
    std::uint32_t* at = begin;
    for (const BoxHits& hit : hits) {
        const auto column = hn::Set(d, columns[hit.column()]);
        const std::uint32_t* row = rows + hit.first_row();
        const std::size_t lane_count = hn::Lanes(d);
        for (std::uint32_t bits = hit.bits(); bits != 0; bits >>= lane_count, row += lane_count) {
            // All lanes are stored. The next store overwrites the lanes beyond the hits.
            const std::uint32_t set = bits & ((1u << lane_count) - 1);
            const auto lanes = hn::PromoteTo(d, hn::LoadU(bytes, lanes_in.of[set].data()));
            const auto hit_rows = hn::TableLookupLanes(hn::LoadU(d, row), hn::IndicesFromVec(d, lanes));
            const auto high = hn::Sub(hn::Max(column, hit_rows), offset);
            hn::StoreInterleaved2(hn::Min(column, hit_rows), high, d, at);
            at += 2 * std::size_t(lanes_in.count[set]);
        }
    }
    return std::size_t(at - begin) / 2;
}

/// Returns the largest absolute value.
float largest_of(std::span<const float> numbers) {
    const hn::CappedTag<float, row_block> d;
    auto most = hn::Zero(d);
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= numbers.size(); i += hn::Lanes(d)) {
        most = hn::Max(most, hn::Abs(hn::LoadU(d, numbers.data() + i)));
    }
    float largest = hn::GetLane(hn::MaxOfLanes(d, most));
    for (; i < numbers.size(); ++i) largest = std::max(largest, std::abs(numbers[i]));
    return largest;
}

/// Returns the largest absolute bound of a set on each axis of the sweep.
Depths largest_bounds_simd(const BoxSet& set) {
    Depths largest;
    for (unsigned k = 0; k < 3; ++k) {
        largest[k] = std::max(largest_of({set.low(k), set.size()}), largest_of({set.high(k), set.size()}));
    }
    return largest;
}

void judge_hits_simd(const BoxSweep& sweep, std::span<const BoxHits> hits, const Depths& depths,
                     std::span<BoxHits> doubtful) {
    const hn::CappedTag<float, row_block> d;
    BoxHits* at = doubtful.data();
    for (const BoxHits& hit : hits) {
        std::uint32_t bits = 0;
        for (std::size_t lane = 0; lane < row_block; lane += hn::Lanes(d)) {
            const std::size_t row = hit.first_row() + lane;
            auto deep = hn::FirstN(d, hn::Lanes(d));
            for (unsigned k = 0; k < 3; ++k) {
                const auto low = hn::Set(d, sweep.columns.low(k)[hit.column()]);
                const auto high = hn::Set(d, sweep.columns.high(k)[hit.column()]);
                const auto depth = hn::Min(hn::Sub(high, hn::LoadU(d, sweep.rows.low(k) + row)),
                                           hn::Sub(hn::LoadU(d, sweep.rows.high(k) + row), low));
                deep = hn::And(deep, hn::Gt(depth, hn::Set(d, depths[sweep.rows.axis(k)])));
            }
            bits |= bits_of(d, deep) << lane;
        }
        *at++ = BoxHits(hit.column(), hit.first_row(), hit.bits() & ~bits);
    }
}

#if HWY_TARGET == HWY_SCALAR

void split_entries_simd(std::span<const Entry> entries, const EntryArrays& arrays) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
        std::array<std::uint32_t, sizeof(Entry) / sizeof(std::uint32_t)> numbers;
        std::memcpy(numbers.data(), &entries[i], sizeof(Entry));
        for (std::size_t k = 0; k < numbers.size(); ++k) arrays[k][i] = numbers[k];
    }
}

#else

/// Transposes four registers of four numbers, and stores them to four arrays.
template <typename D, typename V>
HWY_INLINE void store_turned(D d, const V (&rows)[4], std::uint32_t* const* arrays, std::size_t at) {
    const auto lower02 = hn::InterleaveLower(d, rows[0], rows[2]), lower13 = hn::InterleaveLower(d, rows[1], rows[3]);
    const auto upper02 = hn::InterleaveUpper(d, rows[0], rows[2]), upper13 = hn::InterleaveUpper(d, rows[1], rows[3]);
    hn::Store(hn::InterleaveLower(d, lower02, lower13), d, arrays[0] + at);
    hn::Store(hn::InterleaveUpper(d, lower02, lower13), d, arrays[1] + at);
    hn::Store(hn::InterleaveLower(d, upper02, upper13), d, arrays[2] + at);
    hn::Store(hn::InterleaveUpper(d, upper02, upper13), d, arrays[3] + at);
}

void split_entries_simd(std::span<const Entry> entries, const EntryArrays& arrays) {
    const hn::FixedTag<std::uint32_t, 4> d;
    for (std::size_t i = 0; i < entries.size(); i += 4) {
        const auto at = [&](std::size_t k) {
            return reinterpret_cast<const std::uint32_t*>(&entries[std::min(i + k, entries.size() - 1)]);
        };
        const std::uint32_t* const from[4] = {at(0), at(1), at(2), at(3)};
        store_turned(d, {hn::Load(d, from[0]), hn::Load(d, from[1]), hn::Load(d, from[2]), hn::Load(d, from[3])},
                     arrays.data(), i);
        store_turned(
            d, {hn::Load(d, from[0] + 4), hn::Load(d, from[1] + 4), hn::Load(d, from[2] + 4), hn::Load(d, from[3] + 4)},
            arrays.data() + 4, i);
    }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(find_hits_simd);
HWY_EXPORT(write_pairs_simd);
HWY_EXPORT(largest_bounds_simd);
HWY_EXPORT(judge_hits_simd);
HWY_EXPORT(split_entries_simd);

std::size_t find_hits(const BoxSweep& sweep, BoxCursor& cursor, std::span<BoxHits> hits) {
    return HWY_DYNAMIC_DISPATCH(find_hits_simd)(sweep, cursor, hits);
}

std::size_t write_pairs(const BoxSweep& sweep, std::span<const BoxHits> hits, std::uint32_t second_begin, Pair* pairs) {
    return HWY_DYNAMIC_DISPATCH(write_pairs_simd)(sweep, hits, second_begin, pairs);
}

Depths certain_depths(const BoxSweep& sweep, const RoundingSlack& slack) {
    const Depths rows = HWY_DYNAMIC_DISPATCH(largest_bounds_simd)(sweep.rows);
    const Depths columns =
        sweep.kind == SweepKind::self ? rows : HWY_DYNAMIC_DISPATCH(largest_bounds_simd)(sweep.columns);
    Depths depths;
    for (unsigned k = 0; k < 3; ++k) {
        const unsigned axis = sweep.rows.axis(k);
        depths[axis] = slack.depth(axis, std::max(rows[k], columns[k]));
    }
    return depths;
}

void judge_hits(const BoxSweep& sweep, std::span<const BoxHits> hits, const Depths& depths,
                std::span<BoxHits> doubtful) {
    HWY_DYNAMIC_DISPATCH(judge_hits_simd)(sweep, hits, depths, doubtful);
}

void split_entries(std::span<const Entry> entries, const EntryArrays& arrays) {
    HWY_DYNAMIC_DISPATCH(split_entries_simd)(entries, arrays);
}

}  // namespace octopair

#endif  // HWY_ONCE
