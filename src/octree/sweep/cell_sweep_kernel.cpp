// SIMD versions of the functions of cell_sweep.hpp. Highway compiles them for each instruction set.
//
// - A row is tested against 64 columns at a time, by four saturated subtractions of bytes for each register of columns. In a self sweep, a
//   block of rows whose windows end earlier is tested against 32. All hits are written, without a branch on whether there are any: dense
//   scenes mispredict that branch.
// - Hits are judged apart from the sweep, many at once: the entries of as many hits as a register has lanes are turned into registers of
//   one number each.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/sweep/cell_sweep_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "base/tuning.hpp"
#include "boxes/simd_lanes-inl.hpp"
#include "octree/sweep/cell_sweep.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

std::size_t find_hits_simd(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    return find_hits_scalar(sweep, cursor, hits);
}

void judge_hits_simd(const CellSweep& sweep, std::span<CellHit> hits, const CellDepths& depths, JudgedHits& judged) {
    judge_hits_scalar(sweep, hits, depths, judged);
}

void cell_entries_simd(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out) {
    for (const Entry& entry : entries) *out++ = cells.entry(entry);
}

void write_planes_simd(std::span<const CellEntry> entries, std::uint8_t* planes, std::size_t stride) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const auto bytes = plane_bytes(entries[i]);
        for (std::size_t k = 0; k < cell_planes; ++k) planes[k * stride + i] = bytes[k];
    }
}

#else

constexpr std::size_t row_block = CellSweep::row_block, column_group = CellSweep::column_group;

using SignedHalves = hn::Repartition<std::int16_t, Words>;

/// Returns the first `count` columns, or all if there are fewer, without a branch.
template <std::size_t width>
HWY_INLINE BitMask<width> first_columns(std::size_t count) {
    using Bits = BitMask<width>;
    const Bits bits = Bits(std::min(count, width));
    return (Bits(1) << (bits % width)) - 1 - bits / width;
}

/// The planes of a set.
struct Planes {
    explicit Planes(const CellSet& set)
        : low1(set.plane(CellPlane::low1)),
          high1(set.plane(CellPlane::high1)),
          low2(set.plane(CellPlane::low2)),
          high2(set.plane(CellPlane::high2)) {}
    const std::uint8_t *low1, *high1, *low2, *high2;
};

/// `width` adjacent columns: 64, which are a group, or the first 32.
template <std::size_t width>
class ColumnGroup {
public:
    HWY_INLINE ColumnGroup(const Planes& planes, std::size_t first) {
        for (std::size_t i = 0; i < registers; ++i, first += lanes) {
            low1_[i] = hn::LoadU(D(), planes.low1 + first), high1_[i] = hn::LoadU(D(), planes.high1 + first);
            low2_[i] = hn::LoadU(D(), planes.low2 + first), high2_[i] = hn::LoadU(D(), planes.high2 + first);
        }
    }
    /// Returns the columns that overlap a row.
    HWY_INLINE BitMask<width> overlapping(const Planes& rows, std::size_t row) const {
        const auto low1 = hn::Set(D(), rows.low1[row]), high1 = hn::Set(D(), rows.high1[row]);
        const auto low2 = hn::Set(D(), rows.low2[row]), high2 = hn::Set(D(), rows.high2[row]);
        BitMask<width> hits = 0;
        for (std::size_t i = 0; i < registers; ++i) {
            const auto apart1 = hn::Or(hn::SaturatedSub(low1_[i], high1), hn::SaturatedSub(low1, high1_[i]));
            const auto apart2 = hn::Or(hn::SaturatedSub(low2_[i], high2), hn::SaturatedSub(low2, high2_[i]));
            const auto hit = hn::Eq(hn::Or(apart1, apart2), hn::Zero(D()));
            hits |= BitMask<width>(bits_of(D(), hit)) << (i * lanes);
        }
        return hits;
    }

private:
    using D = hn::CappedTag<std::uint8_t, width>;
    static constexpr std::size_t lanes = hn::MaxLanes(D()), registers = width / lanes;
    hn::Vec<D> low1_[registers], high1_[registers], low2_[registers], high2_[registers];
};

/// Writes `first` + k for each bit k of a set, ascending, and returns their end. `count`: number of columns that may be in the set. May
/// write column_group numbers, of which the next call overwrites those behind the end.
#if HWY_TARGET <= HWY_AVX3_DL

template <std::size_t width>
HWY_INLINE CellHit* write_hits(BitMask<width> set, std::uint32_t, CellHit first, CellHit* out) {
    const hn::CappedTag<std::uint8_t, width> bytes;
    const hn::CappedTag<std::uint32_t, width / 4> d;
    const hn::Half<decltype(bytes)> half;
    const hn::Half<decltype(half)> quarter;
    alignas(64) static constexpr std::uint8_t numbers[64] = {
        0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21,
        22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43,
        44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63};
    std::uint8_t mask[8] = {};
    std::memcpy(mask, &set, sizeof(set));
    const auto columns = hn::Compress(hn::Load(bytes, numbers), hn::LoadMaskBits(bytes, mask));
    const auto store = [&](std::size_t k, auto some) HWY_ATTR {
        hn::StoreU(hn::Add(hn::PromoteTo(d, some), hn::Set(d, first)), d, out + k * hn::Lanes(d));
    };
    const auto lower = hn::LowerHalf(half, columns);
    store(0, hn::LowerHalf(quarter, lower));
    const std::size_t count = hwy::PopCount(set);
    if (HWY_UNLIKELY(count > hn::Lanes(d))) {
        const auto upper = hn::UpperHalf(half, columns);
        store(1, hn::UpperHalf(quarter, lower));
        store(2, hn::LowerHalf(quarter, upper));
        store(3, hn::UpperHalf(quarter, upper));
    }
    return out + count;
}

#elif HWY_TARGET <= HWY_AVX3

template <std::size_t width>
HWY_INLINE CellHit* write_hits(BitMask<width> set, std::uint32_t, CellHit first, CellHit* out) {
    for (std::size_t k = 0; k < width; k += hn::Lanes(Words())) {
        const auto some = std::uint32_t(set >> k) & 0xFFFFu;
        const auto numbers = hn::Add(lane_numbers(), hn::Set(Words(), first + std::uint32_t(k)));
        hn::StoreU(LanesToFront(some)(numbers), Words(), out);
        out += hwy::PopCount(some);
    }
    return out;
}

#else

template <std::size_t width>
HWY_INLINE CellHit* write_hits(BitMask<width> set, std::uint32_t count, CellHit first, CellHit* out) {
    const hn::Rebind<std::uint8_t, Words> bytes;
    auto base = hn::Set(Words(), first);
    for (std::uint32_t k = 0; k < count; k += LaneTable::lanes, set >>= LaneTable::lanes) {
        const std::size_t some = set & 0xFFu;
        for (std::size_t lane = 0; lane < LaneTable::lanes; lane += hn::Lanes(Words())) {
            const auto columns = hn::PromoteTo(Words(), hn::LoadU(bytes, lanes_in.of[some].data() + lane));
            hn::StoreU(hn::Add(columns, base), Words(), out + lane);
        }
        base = hn::Add(base, hn::Set(Words(), std::uint32_t(LaneTable::lanes)));
        out += lanes_in.count[some];
    }
    return out;
}

#endif

static_assert(CellSet::bytes_read_beyond >= column_group);
static_assert(CellSet::entries_read_beyond >= max_lanes && judged_room >= max_lanes);

/// Adjacent rows and the ends of their windows.
template <std::size_t count>
struct RowBlock {
    HWY_INLINE RowBlock(const CellWindows& windows, std::size_t first_row) : row(first_row) {
        for (std::size_t r = 0; r < count; ++r) ends[r] = windows.end(row + r);
        for (const std::size_t one : ends) end = std::max(end, one);
    }
    std::size_t row, end = 0;
    std::size_t ends[count];
};

/// The planes of both sets of a sweep.
struct SweepPlanes {
    Planes rows, columns;
};

/// Tests rows against the columns [base, base + width) of their windows. Writes the hits and returns their end. `begins`: the columns
/// begin the windows of a self sweep, so row r has no column before its successor.
template <std::size_t width, bool begins, std::size_t count>
HWY_INLINE CellHit* test_rows(const SweepPlanes& planes, const RowBlock<count>& block, std::size_t base, CellHit* out) {
    const ColumnGroup<width> columns(planes.columns, base);
    const auto in_windows = std::uint32_t(std::min<std::size_t>(std::max(block.end, base) - base, width));
    for (std::size_t r = 0; r < count; ++r) {
        auto window = first_columns<width>(std::max(block.ends[r], base) - base);
        if (begins) window &= ~BitMask<width>(0) << r;
        const auto hits = columns.overlapping(planes.rows, block.row + r) & window;
        out = write_hits<width>(hits, in_windows, CellHit((block.row + r) << 16 | base), out);
    }
    return out;
}

/// Rows of a self sweep are tested in blocks.
std::size_t find_self_hits(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    constexpr std::size_t narrow = 32;
    const CellWindows windows(sweep);
    const SweepPlanes planes{Planes(sweep.rows), Planes(sweep.rows)};
    CellHit* at = hits.data();
    CellHit* const last = hits.data() + (hits.size() - CellSweep::min_room);
    auto [row, base, in_row] = cursor;
    RunPrefetcher ahead = sweep.ahead == nullptr ? RunPrefetcher() : *sweep.ahead;  // a copy stays in registers
    const std::size_t rows = sweep.rows.size(), rows_end = std::min(rows, row + tuning().sweep.cell_rows_per_call);
    for (; row < rows_end && at <= last; row += row_block, in_row = false) {
        const RowBlock<row_block> block(windows, row);
        const std::size_t end =
            std::max(block.end, row + 1);  // a row whose box changed while it was read may end before it begins
        if (!in_row) {
            ahead.fetch_line();
            base = row + 1;
            if (end - base <= narrow) {
                at = test_rows<narrow, true>(planes, block, base, at);
                continue;
            }
            at = test_rows<column_group, true>(planes, block, base, at);
            base += column_group;
        }
        for (; base < end && at <= last; base += column_group) {
            at = test_rows<column_group, false>(planes, block, base, at);
        }
        if (base < end) {
            in_row = true;
            break;
        }
    }
    if (row >= rows) ahead.fetch_rest();
    if (sweep.ahead != nullptr) *sweep.ahead = ahead;
    cursor = {row, base, in_row};
    return std::size_t(at - hits.data());
}

std::size_t find_cross_hits(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    const CellWindows windows(sweep);
    const SweepPlanes planes{Planes(sweep.rows), Planes(sweep.columns)};
    CellHit* at = hits.data();
    CellHit* const last = hits.data() + (hits.size() - CellSweep::min_room);
    auto [row, base, in_row] = cursor;
    const std::size_t rows_end = std::min(sweep.rows.size(), row + tuning().sweep.cell_rows_per_call);
    for (; row < rows_end; ++row, in_row = false) {
        const RowBlock<1> block(windows, row);
        if (!in_row) base = windows.begin_crossing(row);
        for (; base < block.end && at <= last; base += column_group) {
            at = test_rows<column_group, false>(planes, block, base, at);
        }
        if (base < block.end) {
            in_row = true;
            break;
        }
    }
    cursor = {row, base, in_row};
    return std::size_t(at - hits.data());
}

std::size_t find_hits_simd(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    return sweep.kind == SweepKind::self ? find_self_hits(sweep, cursor, hits) : find_cross_hits(sweep, cursor, hits);
}

void judge_hits_simd(const CellSweep& sweep, std::span<CellHit> hits, const CellDepths& depths, JudgedHits& judged) {
    const Words d;
    const SignedHalves halves;
    const std::size_t lanes = hn::Lanes(d);
    const auto ends = hn::Set(d, CellEntry::end_bits), flags = hn::Set(d, CellEntry::flag_bits);
    const auto lower = hn::BitCast(halves, hn::Set(d, 0xFFFFu));
    const auto none_certain = depths.none_certain ? flags : hn::Zero(d);
    std::fill_n(hits.data() + hits.size(), lanes, 0u);
    Pair* pairs = judged.pairs + judged.pair_count;
    std::uint32_t* doubtful = judged.doubtful + judged.doubtful_count;
    for (std::size_t i = 0; i < hits.size(); i += lanes) {
        Lanes rows[4], columns[4];
        const CellHit* const some = hits.data() + i;
        load_items(rows, [&](std::size_t k) { return sweep.rows.entries()[some[k] >> 16].ends.data(); });
        load_items(columns, [&](std::size_t k) { return sweep.columns.entries()[some[k] & 0xFFFFu].ends.data(); });
        auto apart = hn::Zero(d), doubts = none_certain;
        for (std::size_t k = 0; k < 3; ++k) {
            // Lower half: row's low - column's high. Upper half: row's high - column's low. Negated where it is a depth.
            const auto turned = hn::RotateRight<16>(hn::And(columns[k], ends));
            const auto difference = hn::Sub(hn::BitCast(halves, hn::And(rows[k], ends)), hn::BitCast(halves, turned));
            const auto depth = hn::Sub(hn::Xor(difference, lower), lower);
            const auto over = hn::Sub(depth, hn::Set(halves, std::int16_t(depths.cells[k])));
            apart = hn::Or(apart, hn::Or(hn::BitCast(d, depth), hn::And(rows[k], columns[k])));
            doubts = hn::Or(doubts, hn::BitCast(d, over));
        }
        const auto none = [&](auto numbers)
                              HWY_ATTR { return bits_of(d, hn::Eq(hn::And(numbers, flags), hn::Zero(d))); };
        const std::uint32_t kept = none(apart) & first_lanes(hits.size() - i);
        const LanesToFront kept_to_front(kept);
        hn::StoreInterleaved2(kept_to_front(hn::Min(rows[3], columns[3])), kept_to_front(hn::Max(rows[3], columns[3])),
                              d, reinterpret_cast<std::uint32_t*>(pairs));
        const std::size_t count = hwy::PopCount(kept);
        if ((~none(doubts) & kept) != 0) {
            const std::uint32_t asked = ~none(kept_to_front(doubts)) & first_lanes(count);
            const auto numbers = hn::Add(lane_numbers(), hn::Set(d, std::uint32_t(pairs - judged.pairs)));
            hn::StoreU(LanesToFront(asked)(numbers), d, doubtful);
            doubtful += hwy::PopCount(asked);
        }
        pairs += count;
    }
    judged.pair_count = std::size_t(pairs - judged.pairs);
    judged.doubtful_count = std::size_t(doubtful - judged.doubtful);
}

template <bool deep>
void cell_entries_of(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out) {
    const hn::FixedTag<float, 4> floats;
    const hn::FixedTag<std::uint32_t, 4> words;
    const auto origin = hn::LoadU(floats, deep ? cells.origin.data() : cells.map.origin.data());
    const auto scale = hn::LoadU(floats, deep ? cells.scale.data() : cells.map.scale.data());
    const auto last = deep ? hn::Set(floats, float(last_octant_cell)) : hn::LoadU(floats, cells.map.last.data());
    const auto whole = hn::Set(floats, SpaceMap::whole);
    const auto first_fine = hn::LoadU(words, cells.first.data());
    const auto last_fine = hn::Add(first_fine, hn::Set(words, cells.last_offset));
    const auto fine_bits = hn::Set(words, SpaceMap::last_fine_cell), cell_mask = hn::Set(words, last_octant_cell);
    const auto cell = [&](auto coordinates) HWY_ATTR {
        const auto scaled = hn::Min(hn::Max(hn::Mul(hn::Sub(coordinates, origin), scale), hn::Zero(floats)), last);
        const auto whole_number = hn::BitCast(words, hn::Add(scaled, whole));
        if constexpr (deep) return hn::And(whole_number, cell_mask);
        const auto clamped = hn::Min(hn::Max(hn::And(whole_number, fine_bits), first_fine), last_fine);
        const auto aligned = hn::And(hn::ShiftLeftSame(clamped, int(cells.level)), fine_bits);
        return hn::ShiftRight<int(OctantCells::max_fine_level)>(aligned);
    };
    const auto [x, y, z] = cells.axes;
    alignas(16) const std::uint32_t class_bits[4] = {1u << x, 1u << y, 1u << z, 0};
    alignas(16) constexpr std::uint32_t set_bits[4] = {first_set, second_set, fixed_object, 0};
    alignas(16) const std::int32_t turned[4] = {std::int32_t(x), std::int32_t(y), std::int32_t(z), 3};
    const auto order = hn::SetTableIndices(words, turned);
    const auto class_lanes = hn::Load(words, class_bits), set_lanes = hn::Load(words, set_bits);
    for (const Entry& entry : entries) {
        const auto low = hn::TableLookupLanes(cell(hn::LoadU(floats, entry.min)), order);
        const auto high = hn::TableLookupLanes(cell(hn::LoadU(floats, entry.max)), order);
        const auto mask = hn::Set(words, entry.mask);
        const auto flags =
            hn::Or(hn::IfThenElseZero(hn::TestBit(mask, class_lanes), hn::Set(words, CellEntry::class_bit)),
                   hn::IfThenElseZero(hn::TestBit(mask, set_lanes), hn::Set(words, 1u << CellEntry::set_shift)));
        hn::Store(hn::Or(hn::Or(low, hn::ShiftLeft<16>(high)), flags), words, out->ends.data());
        out++->object = entry.object;
    }
}

void cell_entries_simd(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out) {
    cells.is_deep() ? cell_entries_of<true>(cells, entries, out) : cell_entries_of<false>(cells, entries, out);
}

void write_planes_simd(std::span<const CellEntry> entries, std::uint8_t* planes, std::size_t stride) {
    const Words d;
    const hn::Rebind<std::uint8_t, Words> bytes;
    constexpr int dropped_bits = cell_bits - 8;
    for (std::size_t i = 0; i < entries.size(); i += hn::Lanes(d)) {
        Lanes words[4];
        load_items(words, [&](std::size_t k) { return entries.data()[i + k].ends.data(); });
        const auto store = [&](CellPlane end, Lanes cells) HWY_ATTR {
            const auto low_byte = hn::And(cells, hn::Set(d, 0xFFu));
            hn::StoreU(hn::U8FromU32(low_byte), bytes, planes + std::size_t(end) * stride + i);
        };
        store(CellPlane::low1, hn::ShiftRight<dropped_bits>(words[1]));
        store(CellPlane::high1, hn::ShiftRight<16 + dropped_bits>(words[1]));
        store(CellPlane::low2, hn::ShiftRight<dropped_bits>(words[2]));
        store(CellPlane::high2, hn::ShiftRight<16 + dropped_bits>(words[2]));
    }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(find_hits_simd);
HWY_EXPORT(judge_hits_simd);
HWY_EXPORT(cell_entries_simd);
HWY_EXPORT(write_planes_simd);

std::size_t find_hits(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    return HWY_DYNAMIC_DISPATCH(find_hits_simd)(sweep, cursor, hits);
}

void judge_hits(const CellSweep& sweep, std::span<CellHit> hits, const CellDepths& depths, JudgedHits& judged) {
    HWY_DYNAMIC_DISPATCH(judge_hits_simd)(sweep, hits, depths, judged);
}

void cell_entries(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out) {
    HWY_DYNAMIC_DISPATCH(cell_entries_simd)(cells, entries, out);
}

void write_planes(std::span<const CellEntry> entries, std::uint8_t* planes, std::size_t stride) {
    HWY_DYNAMIC_DISPATCH(write_planes_simd)(entries, planes, stride);
}

}  // namespace octopair

#endif  // HWY_ONCE
