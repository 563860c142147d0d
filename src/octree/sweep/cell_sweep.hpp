// Cell sweep: finds the overlapping boxes of sorted sets of one octant by a sweep along its first axis, on cells.
//
// A sweep tests each row against the columns of its window:
//   self          row i against the columns i + 1, i + 2, ... of the same set
//   cross         a row against the columns of another set that do not begin in a bucket before the row's
//   cross_strict  a row against the columns of another set that begin in a bucket behind the row's
// Every window ends with the bucket of the row's high end. For two sets, rows and columns are compared by the buckets of the set that has
// fewer. One cross sweep, and one cross_strict sweep with rows and columns exchanged, find each pair of two sets once.
//
// Hits may be too many: within a window, the test uses 8 of 15 bits on two axes, and nothing on the first axis. judge_hits() compares all
// bits. If ends differ by fewer cells than their order needs to be certain, the hit is doubtful, and EntrySource::refused() decides with the
// caller's own numbers.
//
// The rows of a self sweep are taken in blocks of 4. The rows of a block are tested against the first 64 columns of their windows, then
// against the next 64, and so on; within such a group, hits are in the order of rows, then of columns. So the order is the same for any
// width of the registers.
//
// The functions whose names end in _scalar are the specification of the SIMD versions (cell_sweep_kernel.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "base/test_hooks.hpp"
#include "boxes/entry_source.hpp"
#include "octree/sweep/cell_set.hpp"
#include "octree/sweep/run_prefetcher.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair {

/// Number of rows of a self sweep that are tested together, and of columns that they are tested against at a time.
inline constexpr std::size_t row_block = 4, column_group = 64;

/// Position of a row, and below it that of a column, in 16 bits each.
using CellHit = std::uint32_t;

struct CellSweep {
    const CellSet& rows;
    const CellSet& columns;  ///< the set of rows if `kind` is `self`
    SweepKind kind;
    RunPrefetcher* ahead = nullptr;  ///< prefetches during a self sweep what is read after it, unless null

    /// Number of rows that are tested together.
    std::size_t block() const { return kind == SweepKind::self ? row_block : 1; }
};

/// Position at which a sweep continues: the next block of rows (CellSweep::block()), and the next column for this block. Rows before `row`
/// are done.
struct CellCursor {
    std::size_t row = 0;
    std::size_t column = 0;
    bool in_row = false;  ///< true if `column` is set for `row`
};

/// Minimum room for hits of cell_hits(): a group's, and 64 that SIMD versions may write behind the last hit.
inline constexpr std::size_t min_hit_room = row_block * column_group + column_group;

/// Continues a sweep at `cursor` and writes hits. Returns their number. Stops early if `hits` has no room for those of another group. Also
/// stops after tuning().sweep.cell_rows_per_call rows, unless the version is scalar. The sweep is done when cursor.row is not below the
/// number of rows.
/// Requires: `hits` has room for at least min_hit_room. The sets have planes, which cell_hits_scalar() does not read.
std::size_t cell_hits(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits);
std::size_t cell_hits_scalar(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits);

/// The cells by which the ends of two boxes must differ, so that their order is certain by the caller's own numbers.
struct CertainGaps {
    std::array<std::uint16_t, 3> cells = {1, 1, 1};  ///< by axis of the sweep
    bool none_certain = false;                       ///< no difference is enough
};
/// Returns the gaps for entries of an octant, whose bounds are rounded as `source` says.
CertainGaps certain_gaps(const OctantCells& cells, const EntrySource& source);

/// Destination of judged hits.
struct JudgedHits {
    Pair* pairs;              ///< (lower object, higher object), in the order of the hits
    std::uint32_t* doubtful;  ///< ascending positions in `pairs` of those that the caller's own numbers must decide
    std::size_t pair_count = 0;
    std::size_t doubtful_count = 0;
};

/// Number of pairs and positions that may be written behind the last one.
inline constexpr std::size_t judged_room = 16;

/// Keeps the hits whose entries overlap in all cells and share no flag.
/// Requires: room for all hits and `judged_room` more, in `judged` and behind the end of `hits`.
void judge_hits(const CellSweep& sweep, std::span<CellHit> hits, const CertainGaps& gaps, JudgedHits& judged);
void judge_hits_scalar(const CellSweep& sweep, std::span<CellHit> hits, const CertainGaps& gaps, JudgedHits& judged);

/// Converts entries to cells of their octant.
void cell_entries(const OctantCells& cells, std::span<const Entry> entries, CellEntry* out);

/// Returns an estimate of the number of columns that a sweep tests, summed over all rows, from rows at fixed positions.
std::uint64_t sampled_tests(const CellSweep& sweep);

/// The windows of the rows of a sweep: positions [begin(row), end(row)) of columns, none if end() is not above begin(). A row may be one of
/// the entries behind the last row. Shared by all versions.
class CellWindows {
public:
    explicit CellWindows(const CellSweep& sweep)
        : rows_(sweep.rows.entries()),
          begins_(sweep.columns.bucket_begins()),
          column_shift_(sweep.columns.bucket_shift()),
          shift_(std::max(sweep.rows.bucket_shift(), column_shift_)),
          kind_(sweep.kind) {}

    std::size_t begin(std::size_t row) const { return kind_ == SweepKind::self ? row + 1 : begin_crossing(row); }
    /// Returns begin(row) of a sweep of two sets.
    std::size_t begin_crossing(std::size_t row) const {
        const std::uint32_t bucket = (rows_[row].low(0) >> shift_) + (kind_ == SweepKind::cross_strict ? 1 : 0);
        return begins_[bucket << shift_ >> column_shift_];
    }
    std::size_t end(std::size_t row) const {
        const std::size_t end = begins_[(rows_[row].high(0) >> column_shift_) + 1];
        const bool cut = planted(Fault::cell_window_end_open) && kind_ == SweepKind::self && end > row + 1;
        return cut ? end - 1 : end;
    }

private:
    const CellEntry* rows_;
    const std::uint32_t* begins_;
    unsigned column_shift_, shift_;
    SweepKind kind_;
};

}  // namespace octopair
