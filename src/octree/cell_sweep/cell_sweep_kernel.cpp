// SIMD versions of the functions of cell_sweep.hpp and cell_set.hpp. Highway compiles them for each instruction set.
//
// - A register of columns is tested against one row by two saturated subtractions. All hits are written, without a branch on
//   whether there are any: dense scenes mispredict that branch.
// - A row first tests a fixed number of registers. So most rows do not mispredict where their columns end.
// - Hits are judged apart from the sweep, many at once: four entries are turned into four registers of one number each.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/cell_sweep/cell_sweep_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <bit>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/cell_sweep/cell_sweep.hpp"
#include "octree/simd_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

std::size_t cell_hits_simd(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    return cell_hits_scalar(sweep, cursor, hits);
}

void judge_hits_simd(const CellSweep& sweep, std::span<CellHit> hits, const CertainGaps& gaps, JudgedHits& judged) {
    judge_hits_scalar(sweep, hits, gaps, judged);
}

void cell_entries_simd(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out) {
    for (const Entry& entry : entries) *out++ = cells.entry(entry);
}

void place_entries_simd(std::span<const CellEntry> entries, const EntryPlaces& places) {
    const auto [buckets, next, entries_out, first_axis_out, other_axes_out] = places;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const std::uint32_t at = next[buckets[i]]++;
        const CellColumn column = column_of(entries[i]);
        entries_out[at] = entries[i];
        first_axis_out[at] = column.first_axis;
        other_axes_out[at] = column.other_axes;
    }
}

#else

using Halves = hn::Repartition<std::uint16_t, Words>;
using SignedHalves = hn::Repartition<std::int16_t, Words>;
using Bytes = hn::Repartition<std::uint8_t, Words>;

/// A row, turned so that it compares with columns: its ends in exchanged places, and complemented.
struct TurnedRow {
    HWY_INLINE TurnedRow(const CellSet& rows, std::size_t row)
        : first(hn::Set(Words(), std::rotl(~rows.first_axis()[row], 16))),
          others(hn::Set(Words(), swap_bytes(~rows.other_axes()[row]))),
          number(hn::Set(Words(), std::uint32_t(row) << 16)) {}
    static std::uint32_t swap_bytes(std::uint32_t halves) {
        return (halves & 0x00FF00FFu) << 8 | (halves >> 8 & 0x00FF00FFu);
    }
    Lanes first, others, number;
};

/// A register of columns.
struct Columns {
    HWY_INLINE Columns(const CellSet& columns, std::size_t column)
        : first(hn::LoadU(Words(), columns.first_axis() + column)),
          others(hn::LoadU(Words(), columns.other_axes() + column)),
          number(hn::Set(Words(), std::uint32_t(column))) {}
    Lanes first, others, number;
};

/// Returns the set of columns that overlap a row.
HWY_INLINE std::uint32_t overlapping(const TurnedRow& row, const Columns& columns) {
    const Words d;
    const auto apart0 = hn::SaturatedSub(hn::BitCast(Halves(), columns.first), hn::BitCast(Halves(), row.first));
    const auto apart1 = hn::SaturatedSub(hn::BitCast(Bytes(), columns.others), hn::BitCast(Bytes(), row.others));
    const auto apart = hn::Or(hn::BitCast(d, apart0), hn::BitCast(d, apart1));
    return bits_of(d, hn::Eq(apart, hn::Zero(d)));
}

/// Which columns count, besides those that overlap: all, or those after the row, or those that do not begin before a cell.
enum class Asked { all, after_row, from_cell };

/// A block of rows.
struct RowBlock {
    TurnedRow rows[row_block];
    std::uint32_t from[row_block];  ///< by row: for Asked::from_cell
};

/// Tests a block of rows against a group of columns. Writes the hits and returns their end.
template <Asked asked>
HWY_INLINE CellHit* test_group(const RowBlock& block, const CellSet& set, std::size_t column, CellHit* out) {
    const Words d;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    constexpr std::size_t registers = column_group / lanes;
    const auto test = [&](std::uint32_t r, const Columns& columns, std::size_t lane) HWY_ATTR {
        std::uint32_t hits = overlapping(block.rows[r], columns);
        if constexpr (asked == Asked::after_row) hits &= 0xFFu << r >> lane;
        if constexpr (asked == Asked::from_cell) {
            const auto begin = hn::And(columns.first, hn::Set(d, 0xFFFFu));
            hits &= ~bits_of(d, hn::Lt(begin, hn::Set(d, block.from[r])));
        }
        // All lanes are stored. The next store overwrites the lanes beyond the hits.
        hn::StoreU(hn::Add(lane_numbers(lanes_in.of[hits]), hn::Add(columns.number, block.rows[r].number)), d, out);
        out += std::popcount(hits);
    };
    if constexpr (registers == 1) {
        const Columns columns(set, column);
        for (std::uint32_t r = 0; r < row_block; ++r) test(r, columns, 0);
    } else {
        for (std::uint32_t r = 0; r < row_block; ++r) {
            for (std::size_t lane = 0; lane < column_group; lane += lanes) test(r, Columns(set, column + lane), lane);
        }
    }
    return out;
}

static_assert(CellSet::padding >= row_block + column_group);
static_assert(min_hit_room >= row_block * column_group + LaneTable::lanes);

template <bool self>
std::size_t cell_hits_of(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    constexpr Asked usual = self ? Asked::all : Asked::from_cell;
    const std::uint32_t* const first = sweep.columns.first_axis();
    CellHit* at = hits.data();
    CellHit* const last = hits.data() + (hits.size() - row_block * column_group - LaneTable::lanes);
    std::size_t groups_left = tuning().sweep.tests_per_call;
    for (; cursor.row < sweep.rows.size(); cursor.row += row_block, cursor.in_row = false) {
        const std::size_t row = cursor.row;
        const bool begins = !cursor.in_row;
        if (!start_rows(sweep, cursor)) {
            cursor.row = sweep.rows.size();
            break;
        }
        const auto turned = [&](std::size_t r) HWY_ATTR { return TurnedRow(sweep.rows, row + r); };
        RowBlock block = {{turned(0), turned(1), turned(2), turned(3)}, {}};
        for (std::size_t r = 0; !self && r < row_block; ++r) block.from[r] = first_tested(sweep, row + r);
        const std::uint32_t reach = block_reach(sweep, row);
        std::size_t column = cursor.column;
        if (self && begins && at <= last) {
            at = test_group<Asked::after_row>(block, sweep.columns, column, at);
            column += column_group;
        }
        for (; (first[column] & 0xFFFFu) <= reach && at <= last && groups_left > 0; column += column_group) {
            --groups_left;
            at = test_group<usual>(block, sweep.columns, column, at);
        }
        if (at > last || groups_left == 0) {
            cursor.column = column;
            break;
        }
    }
    return std::size_t(at - hits.data());
}

std::size_t cell_hits_simd(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    return sweep.kind == SweepKind::self ? cell_hits_of<true>(sweep, cursor, hits)
                                         : cell_hits_of<false>(sweep, cursor, hits);
}

/// Loads the entries at some positions: register i gets number i of all entries.
HWY_INLINE void load_entries(const CellEntry* entries, const std::uint32_t* positions, Lanes (&registers)[4]) {
    load_items(registers, [&](std::size_t i) { return entries[positions[i]].ends.data(); });
}

void judge_hits_simd(const CellSweep& sweep, std::span<CellHit> hits, const CertainGaps& gaps, JudgedHits& judged) {
    const Words d;
    const SignedHalves halves;
    const std::size_t lanes = hn::Lanes(d);
    const auto ends = hn::Set(d, CellEntry::end_bits), flags = hn::Set(d, CellEntry::flag_bits);
    const auto lower = hn::BitCast(halves, hn::Set(d, 0xFFFFu));
    const auto none_certain = gaps.none_certain ? flags : hn::Zero(d);
    std::fill_n(hits.data() + hits.size(), lanes, 0u);
    Pair* pairs = judged.pairs + judged.pair_count;
    std::uint32_t* doubtful = judged.doubtful + judged.doubtful_count;
    for (std::size_t i = 0; i < hits.size(); i += lanes) {
        alignas(32) std::uint32_t row_at[LaneTable::lanes], column_at[LaneTable::lanes];
        const auto hit = hn::LoadU(d, hits.data() + i);
        const auto row_of = hn::ShiftRight<16>(hit);
        hn::Store(row_of, d, row_at);
        hn::Store(hn::And(hit, hn::Set(d, 0xFFFFu)), d, column_at);
        Lanes rows[4], columns[4];
        if (hn::AllTrue(d, hn::Eq(row_of, hn::Set(d, row_at[0])))) {
            const CellEntry& row = sweep.rows.entries()[row_at[0]];
            for (std::size_t k = 0; k < 3; ++k) rows[k] = hn::Set(d, row.ends[k]);
            rows[3] = hn::Set(d, row.object);
        } else {
            load_entries(sweep.rows.entries(), row_at, rows);
        }
        load_entries(sweep.columns.entries(), column_at, columns);
        auto apart = hn::Zero(d), doubts = none_certain;
        for (std::size_t k = 0; k < 3; ++k) {
            // Lower half: row's low - column's high. Upper half: row's high - column's low. Negated where it is a depth.
            const auto turned = hn::RotateRight<16>(hn::And(columns[k], ends));
            const auto difference = hn::Sub(hn::BitCast(halves, hn::And(rows[k], ends)), hn::BitCast(halves, turned));
            const auto depth = hn::Sub(hn::Xor(difference, lower), lower);
            const auto over = hn::Sub(depth, hn::Set(halves, std::int16_t(gaps.cells[k])));
            apart = hn::Or(apart, hn::Or(hn::BitCast(d, depth), hn::And(rows[k], columns[k])));
            doubts = hn::Or(doubts, hn::BitCast(d, over));
        }
        const std::size_t left = hits.size() - i;
        const std::uint32_t live = left >= lanes ? 0xFFu : (1u << left) - 1;
        const std::uint32_t kept = bits_of(d, hn::Eq(hn::And(apart, flags), hn::Zero(d))) & live;
        const auto order = to_front(kept);
        const auto lower_object = hn::Min(rows[3], columns[3]), higher_object = hn::Max(rows[3], columns[3]);
        hn::StoreInterleaved2(hn::TableLookupLanes(lower_object, order), hn::TableLookupLanes(higher_object, order), d,
                              reinterpret_cast<std::uint32_t*>(pairs));
        const std::uint32_t asked = bits_of(d, hn::Ne(hn::And(doubts, flags), hn::Zero(d))) & kept;
        if (asked != 0) {
            const auto base = hn::Set(d, std::uint32_t(pairs - judged.pairs));
            const auto positions = hn::Add(lane_numbers(lanes_in.rank[kept]), base);
            hn::StoreU(hn::TableLookupLanes(positions, to_front(asked)), d, doubtful);
            doubtful += lanes_in.count[asked];
        }
        pairs += lanes_in.count[kept];
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
        const auto flags = hn::Or(hn::IfThenElseZero(hn::TestBit(mask, class_lanes), hn::Set(words, 1u << 15)),
                                  hn::IfThenElseZero(hn::TestBit(mask, set_lanes), hn::Set(words, 1u << 31)));
        hn::Store(hn::Or(hn::Or(low, hn::ShiftLeft<16>(high)), flags), words, out->ends.data());
        out++->object = entry.object;
    }
}

void cell_entries_simd(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out) {
    cells.is_deep() ? cell_entries_of<true>(cells, entries, out) : cell_entries_of<false>(cells, entries, out);
}

void place_entries_simd(std::span<const CellEntry> entries, const EntryPlaces& places) {
    const hn::FixedTag<std::uint32_t, 4> words;
    const hn::FixedTag<std::uint16_t, 8> halves;
    const hn::FixedTag<std::uint8_t, 16> bytes;
    alignas(16) constexpr std::uint8_t chosen[16] = {0, 1, 2, 3, 4, 6, 8, 10, 0, 0, 0, 0, 0, 0, 0, 0};
    alignas(16) constexpr std::uint8_t turned[16] = {0, 0, 0xFF, 0xFF, 0, 0xFF, 0, 0xFF, 0, 0, 0, 0, 0, 0, 0, 0};
    alignas(16) constexpr std::uint16_t first_axis_bits[8] = {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0, 0};
    const auto order = hn::Load(bytes, chosen), complement = hn::Load(bytes, turned);
    const auto first_axis = hn::Load(halves, first_axis_bits);
    const auto [buckets, next, entries_out, first_axis_out, other_axes_out] = places;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const std::uint32_t at = next[buckets[i]]++;
        const auto entry = hn::Load(words, entries[i].ends.data());
        hn::Store(entry, words, entries_out[at].ends.data());
        const auto cells = hn::BitCast(halves, hn::And(entry, hn::Set(words, CellEntry::end_bits)));
        const auto mixed = hn::IfVecThenElse(first_axis, cells, hn::ShiftRight<cell_bits - 8>(cells));
        const auto column = hn::Xor(hn::TableLookupBytes(hn::BitCast(bytes, mixed), order), complement);
        const auto pair = hn::BitCast(hn::FixedTag<std::uint64_t, 2>(), column);
        const std::uint64_t both = hn::GetLane(pair);
        first_axis_out[at] = std::uint32_t(both);
        other_axes_out[at] = std::uint32_t(both >> 32);
    }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(cell_hits_simd);
HWY_EXPORT(judge_hits_simd);
HWY_EXPORT(cell_entries_simd);
HWY_EXPORT(place_entries_simd);

std::size_t cell_hits(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    return HWY_DYNAMIC_DISPATCH(cell_hits_simd)(sweep, cursor, hits);
}

void judge_hits(const CellSweep& sweep, std::span<CellHit> hits, const CertainGaps& gaps, JudgedHits& judged) {
    HWY_DYNAMIC_DISPATCH(judge_hits_simd)(sweep, hits, gaps, judged);
}

void cell_entries(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out) {
    HWY_DYNAMIC_DISPATCH(cell_entries_simd)(cells, entries, out);
}

void place_entries(std::span<const CellEntry> entries, const EntryPlaces& places) {
    HWY_DYNAMIC_DISPATCH(place_entries_simd)(entries, places);
}

}  // namespace octopair

#endif  // HWY_ONCE
