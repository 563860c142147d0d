// Cell sweep: finds the overlapping boxes of sorted sets of one octant by a sweep along its first axis, on cells.
//
// A sweep tests each row against the columns that begin within the row:
//   self          row i against the columns i + 1, i + 2, ... of the same set
//   cross         a row against the columns of another set that do not begin in a bucket before the row's
//   cross_strict  a row against the columns of another set that begin in a bucket behind the row's
// A bucket is the coarser of the two sets' buckets.
// One cross sweep, and one cross_strict sweep with rows and columns exchanged, find each pair of two sets once.
//
// Hits may be a few too many: the test uses 8 of 15 bits on two axes. judge_hits() compares all bits. If ends differ by fewer
// cells than their order needs to be certain, the hit is doubtful, and PairRule::refused() decides with the caller's own numbers.
//
// Rows are taken in blocks of 4. A block is tested against groups of 8 columns, in turn; within a group, hits are in the order
// of rows, then of columns. So the order is the same for any width of the registers.
//
// The functions whose names end in _scalar are the specification of the SIMD versions (cell_sweep_kernel.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "base/test_hooks.hpp"
#include "boxes/pair_rule.hpp"
#include "octree/cell_sweep/cell_set.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair {

/// Number of rows that are tested together, and of columns that they are tested against at a time.
inline constexpr std::size_t row_block = 4, column_group = 8;

/// Position of a row, and below it that of a column, in 16 bits each.
using CellHit = std::uint32_t;

struct CellSweep {
    const CellSet& rows;
    const CellSet& columns;  ///< the set of rows if `kind` is `self`
    SweepKind kind;
};

/// Position at which a sweep continues: the next block of rows, and the next column for this block. Rows before `row` are done.
struct CellCursor {
    std::size_t row = 0;
    std::size_t column = 0;
    std::size_t first_column = 0;  ///< cross and cross_strict: first column that `row` is tested against
    bool in_row = false;           ///< true if `column` is set for `row`
};

/// Minimum room for hits of cell_hits().
inline constexpr std::size_t min_hit_room = 128;

/// Continues a sweep at `cursor` and writes hits. Returns their number. Stops early if `hits` is full, or
/// after a bounded number of tests. The sweep is done when cursor.row is not below the number of rows.
/// Requires: `hits` has room for at least min_hit_room.
std::size_t cell_hits(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits);
std::size_t cell_hits_scalar(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits);

/// The cells by which the ends of two boxes must differ, so that their order is certain by the caller's own numbers.
struct CertainGaps {
    std::array<std::uint16_t, 3> cells = {1, 1, 1};  ///< by axis of the sweep
    bool none_certain = false;                       ///< no difference is enough
};
/// Returns the gaps for entries of an octant, whose bounds are rounded as `rule` says.
CertainGaps certain_gaps(const OctantCells& cells, const PairRule& rule);

/// Destination of judged hits.
struct JudgedHits {
    Pair* pairs;              ///< (lower object, higher object), in the order of the hits
    std::uint32_t* doubtful;  ///< ascending positions in `pairs` of those that the caller's own numbers must decide
    std::size_t pair_count = 0;
    std::size_t doubtful_count = 0;
};

/// Number of pairs and positions that may be written behind the last one.
inline constexpr std::size_t judged_room = 8;

/// Keeps the hits whose entries overlap in all cells and share no flag.
/// Requires: room for all hits and `judged_room` more, in `judged` and behind the end of `hits`.
void judge_hits(const CellSweep& sweep, std::span<CellHit> hits, const CertainGaps& gaps, JudgedHits& judged);
void judge_hits_scalar(const CellSweep& sweep, std::span<CellHit> hits, const CertainGaps& gaps, JudgedHits& judged);

/// Converts entries to cells of their octant.
void cell_entries(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out);

/// Returns an estimate of the number of columns that a sweep tests, summed over all rows, from rows at fixed positions.
std::uint64_t sampled_tests(const CellSweep& sweep);

/// Returns the cell that columns must not begin before to be tested against a row; sweeps of two sets. Shared by all versions.
inline std::uint32_t first_tested(const CellSweep& sweep, std::size_t row) {
    const unsigned shift = std::max(sweep.rows.bucket_shift(), sweep.columns.bucket_shift());
    const std::uint32_t bucket = (sweep.rows.first_axis()[row] & 0xFFFFu) >> shift;
    return (bucket + (sweep.kind == SweepKind::cross_strict ? 1 : 0)) << shift;
}

/// Moves `cursor` to the first column of its block of rows, unless the cursor is there already. Returns false if no column is
/// left for these rows and all later rows. Shared by all versions.
bool start_crossing_rows(const CellSweep& sweep, CellCursor& cursor);
inline bool start_rows(const CellSweep& sweep, CellCursor& cursor) {
    if (cursor.in_row) return true;
    cursor.in_row = true;
    if (sweep.kind != SweepKind::self) return start_crossing_rows(sweep, cursor);
    cursor.column = cursor.row + 1;
    return true;
}

/// Returns the last cell at which columns may begin that a block of rows is tested against. Shared by all versions.
inline std::uint32_t block_reach(const CellSweep& sweep, std::size_t row) {
    // The high ends are stored as complements, and rows behind the last one have the greatest complement.
    std::uint32_t least = 0xFFFF;
    for (std::size_t r = row; r < row + row_block; ++r) least = std::min(least, sweep.rows.first_axis()[r] >> 16);
    if (planted(Fault::cell_window_end_open)) return (least ^ 0xFFFFu) - std::min(least ^ 0xFFFFu, 1u);
    return (least ^ 0xFFFFu) | ((1u << sweep.columns.bucket_shift()) - 1);
}

}  // namespace octopair
