// Cell sweep: finds the overlapping boxes of sorted sets of one octant by a sweep along its first axis, on cells.
//
// Layout of a CellSet
//   Entries are in buckets by their low cell on the first axis, in a bucket by their position in the list.
//   Planes have what a sweep reads of the entries: for each end on the two other axes, an array of its 8 most significant bits.
//   Behind the last entry are entries and bytes that a sweep may read. An entry behind the last one reaches the end of the octant, so its
//   window ends with the set.
//
// The windows of a sweep are those of SweepKind, by buckets: a column of the row's bucket counts as if row and column begin together.
// Every window ends with the bucket of the row's high end. For two sets, rows and columns are compared by the buckets of the set that has
// fewer.
//
// Hits may be too many: within a window, the test uses 8 of 15 bits on two axes, and nothing on the first axis. judge_hits() compares all
// bits. If ends differ by fewer cells than their order needs to be certain, the hit is doubtful, and EntrySource::refused() decides with
// the caller's own numbers.
//
// The rows of a self sweep are taken in blocks of 4. The rows of a block are tested against the first 64 columns of their windows, then
// against the next 64, and so on; within such a group, hits are in the order of rows, then of columns. So the order is the same for any
// width of the registers.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "base/test_hooks.hpp"
#include "boxes/entry_source.hpp"
#include "octree/executor.hpp"
#include "octree/plan/octant_cells.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair {

/// A plane of a CellSet: an end on the second or third axis of the sweep.
enum class CellPlane : std::uint8_t { low1, high1, low2, high2 };
inline constexpr std::size_t cell_planes = 4;

class CellSet {
public:
    /// Number of bytes of a plane, and number of entries, that may be read behind the last one.
    static constexpr std::size_t bytes_read_beyond = 64, entries_read_beyond = 16;

    using Runs = std::span<const std::span<const CellEntry>>;
    /// Sorts the entries of all runs. The set has no planes then.
    /// Requires: at most 2^16 entries (tuning().scan.max_swept_list), because a CellHit has 16 bits for a position.
    void assign(Runs runs);

    /// Sorts the entries along the next axis, which becomes the first. The set has no planes then.
    void turn();

    /// Makes the planes, unless the set has them. A sweep requires them.
    void make_planes();

    std::size_t size() const { return size_; }
    const CellEntry* entries() const { return entries_.data(); }
    const std::uint8_t* plane(CellPlane end) const { return planes_.data() + std::size_t(end) * stride_; }
    /// Returns the number of low bits of a cell by which the entries of a bucket may differ.
    unsigned bucket_shift() const { return bucket_shift_; }
    /// Returns the position of the first entry of each bucket, and behind them the number of entries.
    const std::uint32_t* bucket_begins() const { return bucket_begins_.data(); }

private:
    Buffer<CellEntry> entries_;
    std::vector<CellEntry> turned_;
    Buffer<std::uint8_t> planes_;
    std::vector<std::uint32_t> bucket_begins_;
    std::vector<std::uint16_t> buckets_;
    std::size_t size_ = 0;
    std::size_t stride_ = 0;  // from a plane to the next one
    unsigned bucket_shift_ = 0;
    bool has_planes_ = false;
};

/// Returns the bytes of an entry, by CellPlane. Specification of write_planes().
std::array<std::uint8_t, cell_planes> plane_bytes(const CellEntry& entry);

/// Writes the bytes of the entries to planes that begin `stride` bytes apart.
/// Requires: entries_read_beyond more entries can be read, and as many bytes more written to each plane.
void write_planes(std::span<const CellEntry> entries, std::uint8_t* planes, std::size_t stride);

/// Prefetches the entries that a later step reads, while a sweep computes: runs of entries, a cache line at a time. Borrows the span of the
/// runs.
class RunPrefetcher {
public:
    RunPrefetcher() = default;
    explicit RunPrefetcher(std::span<const std::span<const CellEntry>> runs) : runs_(runs) {}

    /// Prefetches the next line, if there is one.
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
    void fetch_rest() {
        while (at_ != end_ || !runs_.empty()) fetch_line();
    }

private:
    std::span<const std::span<const CellEntry>> runs_;
    const CellEntry *at_ = nullptr, *end_ = nullptr;
};

/// Position of a row, and below it that of a column, in 16 bits each.
using CellHit = std::uint32_t;

/// Position at which a sweep continues: the next block of rows (CellSweep::block()), and the next column for this block. Rows before `row`
/// are done.
struct CellCursor {
    std::size_t row = 0;
    std::size_t column = 0;
    bool in_row = false;  ///< true if `column` is set for `row`
};

struct CellSweep {
    using Cursor = CellCursor;
    using Hit = CellHit;
    static constexpr Path resumed = Path::cell_sweep_resumed;
    /// Number of rows of a self sweep that are tested together, and of columns that they are tested against at a time.
    static constexpr std::size_t row_block = 4, column_group = 64;
    /// Minimum room for hits of find_hits(): a group's, and 64 that SIMD versions may write behind the last hit.
    static constexpr std::size_t min_room = row_block * column_group + column_group;

    const CellSet& rows;
    const CellSet& columns;  ///< the set of rows if `kind` is `self`
    SweepKind kind;
    RunPrefetcher* ahead = nullptr;  ///< prefetches during a self sweep what is read after it, unless null

    /// Number of rows that are tested together.
    std::size_t block() const { return kind == SweepKind::self ? row_block : 1; }
};

/// Continues a sweep at `cursor` and writes hits. Returns their number. Stops early if `hits` has no room for those of another group. Also
/// stops after tuning().sweep.cell_rows_per_call rows, unless the version is scalar. The sweep is done when cursor.row is not below the
/// number of rows.
/// Requires: `hits` has room for at least CellSweep::min_room. The sets have planes, which find_hits_scalar() does not read.
std::size_t find_hits(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits);
std::size_t find_hits_scalar(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits);

/// Depths of overlap in cells. Boxes that overlap by at least as many cells on all axes are certain to overlap by the caller's own numbers.
struct CellDepths {
    std::array<std::uint16_t, 3> cells = {1, 1, 1};  ///< by axis of the sweep
    bool none_certain = false;                       ///< no depth is enough
};
/// Returns the depths for entries of an octant, whose bounds are rounded as `source` says.
CellDepths certain_depths(const OctantCells& cells, const EntrySource& source);

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
void judge_hits(const CellSweep& sweep, std::span<CellHit> hits, const CellDepths& depths, JudgedHits& judged);
void judge_hits_scalar(const CellSweep& sweep, std::span<CellHit> hits, const CellDepths& depths, JudgedHits& judged);

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

/// Turns the hits of cell sweeps into pairs of the caller's objects, for one share of the work.
/// Thread safety: one thread at a time.
class CellPairMaker {
public:
    /// Memory of sweep(). The constructor sets its size.
    struct Memory {
        Buffer<CellHit> hits;
        Buffer<Pair> pairs;
        Buffer<std::uint32_t> doubtful, refused;
    };
    /// Borrows `context` and `memory`.
    CellPairMaker(const ScanContext& context, Memory& memory);

    /// Runs a sweep to its end and passes its pairs to `writer`.
    /// Throws: Error{cancelled}.
    void sweep(const CellSweep& sweep, const CellDepths& depths, ShareWriter& writer);

private:
    std::size_t drop_refused(JudgedHits& judged);
    void check(std::span<const Pair> pairs) const;

    const ScanContext& context_;
    Memory& memory_;
};

}  // namespace octopair
