// Box sweep: finds the overlapping boxes of sorted sets by a sweep along one axis, on the bounds in float32. For crowds (scan/crowd.hpp).
//
// Layout of a BoxSet
//   Boxes are in the order (low bound on the axis, position), as a structure of arrays. At its end is padding that hits nothing.
//
// The windows of a sweep are those of SweepKind, by the bounds: they end where the row ends on the axis.
//
// Rows are taken in blocks of 8. A block is tested against the columns that begin within any of its rows. Hits are written as
// one bit mask over the rows for each column: block by block, columns ascending, for any width of the registers.
//
// A hit becomes a pair unless
//   the row and the column are not in the order that the search requires (Orientation, recursive_sweep.hpp), or
//   the boxes overlap so little that rounding could have caused the hit, and the caller's own numbers give no pair.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/memory.hpp"
#include "base/tuning.hpp"
#include "boxes/entry.hpp"
#include "octopair/objects.hpp"
#include "octree/executor.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair {

class BoxSet {
public:
    static constexpr std::size_t padding = 32;  ///< number of columns that may be read beyond the end

    /// Stores the entries. Requires: they ascend by their low ends on the axis.
    void assign(std::span<const Entry> entries, unsigned axis);

    std::size_t size() const { return size_; }
    /// Returns the bounds on the sweep's axis (0) or on one of the two other axes (1, 2).
    const float* low(unsigned axis) const { return numbers_.data() + axis * stride_; }
    const float* high(unsigned axis) const { return numbers_.data() + (3 + axis) * stride_; }
    const std::uint32_t* mask() const { return words_.data(); }
    const std::uint32_t* object() const { return words_.data() + stride_; }
    /// Returns the coordinate axis of low(k) and high(k).
    unsigned axis(unsigned k) const { return axes_[k]; }
    /// Returns entry `i` in its original form.
    Entry entry(std::size_t i) const;

private:
    Buffer<float> numbers_;
    Buffer<std::uint32_t> words_;
    std::size_t size_ = 0;
    std::size_t stride_ = 0;
    std::array<unsigned, 3> axes_ = {0, 1, 2};
};

/// Destination array of each 32-bit number of an Entry.
using EntryArrays = std::array<std::uint32_t*, sizeof(Entry) / sizeof(std::uint32_t)>;

/// Writes the numbers of the entries to separate arrays.
/// Requires: each array is aligned to 16 bytes and has room for 3 more numbers.
void split_entries(std::span<const Entry> entries, const EntryArrays& arrays);

/// A column and the rows of one block that hit it.
class BoxHits {
public:
    /// Maximum number of hits: the number of rows of a block.
    static constexpr std::size_t max_count = 8;

    BoxHits() = default;
    /// `first_row`: first row of the block, below 2^24. Bit k of `bits`: row first_row + k.
    BoxHits(std::uint32_t column, std::size_t first_row, std::uint32_t bits)
        : column_(column), rows_(std::uint32_t(first_row) << max_count | bits) {}

    std::uint32_t column() const { return column_; }
    std::uint32_t first_row() const { return rows_ >> max_count; }
    std::uint32_t bits() const { return rows_ & ((1u << max_count) - 1); }
    /// Clears the rows that are not in `bits`.
    void keep(std::uint32_t bits) { rows_ &= bits | ~((1u << max_count) - 1); }

private:
    std::uint32_t column_;
    std::uint32_t rows_;
};

/// Position at which a sweep continues: the next block of rows, and the next column for this block. Rows before `row` are done.
struct BoxCursor {
    std::size_t row = 0;
    std::size_t column = 0;
    std::size_t first_column =
        0;                ///< cross: first column that does not begin before `row`; cross_strict: that begins after
    bool in_row = false;  ///< true if `column` is set for `row`
};

struct BoxSweep {
    using Cursor = BoxCursor;
    using Hit = BoxHits;
    static constexpr Path resumed = Path::sweep_resumed;
    /// Number of rows that are tested together, and maximum number of columns that they are tested against at a time.
    static constexpr std::size_t row_block = BoxHits::max_count, column_group = 8;
    /// Minimum room for hits of find_hits().
    static constexpr std::size_t min_room = column_group;

    const BoxSet& rows;
    const BoxSet& columns;  ///< the set of rows if `kind` is `self`
    SweepKind kind;
};

/// Continues a sweep at `cursor` and writes hits to `hits`. Returns the number of elements written. Stops early if `hits` is full
/// or after a bounded number of tests, with `cursor` at the next test. The sweep is done when cursor.row is not below the
/// number of rows.
/// Requires: `hits` has room for at least BoxSweep::min_room.
std::size_t find_hits(const BoxSweep& sweep, BoxCursor& cursor, std::span<BoxHits> hits);
/// Tests one column at a time.
std::size_t find_hits_scalar(const BoxSweep& sweep, BoxCursor& cursor, std::span<BoxHits> hits);

/// Returns a depth of overlap for each axis. A hit whose boxes overlap deeper on all axes is certain: rounding cannot have caused it.
Depths certain_depths(const BoxSweep& sweep, const RoundingSlack& slack);

/// Writes the doubtful hits among `hits`, element by element: those whose boxes do not overlap by more than `depths` on all axes.
/// Specification: deep() (boxes/entry.hpp).
/// Requires: `doubtful` has the size of `hits`.
void judge_hits(const BoxSweep& sweep, std::span<const BoxHits> hits, const Depths& depths,
                std::span<BoxHits> doubtful);

/// Writes the pairs of hits, in order, as (lower object, higher object - `second_begin`). Returns the number of pairs.
/// Requires: `pairs` has room for BoxHits::max_count pairs of each element.
std::size_t write_pairs(const BoxSweep& sweep, std::span<const BoxHits> hits, std::uint32_t second_begin, Pair* pairs);

/// Moves `cursor` to the first column of its rows, for cross and cross_strict sweeps. Called by start_rows() only.
void start_crossing_rows(const BoxSweep& sweep, BoxCursor& cursor);

/// Moves `cursor` to the first column of its rows, unless the cursor is there already. Shared by all versions.
inline void start_rows(const BoxSweep& sweep, BoxCursor& cursor) {
    if (cursor.in_row) return;
    if (sweep.kind == SweepKind::self) {
        cursor.column = cursor.row;
    } else {
        start_crossing_rows(sweep, cursor);
    }
    cursor.in_row = true;
}

/// By axis: +1 keeps hits whose row comes before the column (comes_before()), -1 keeps hits whose column comes first,
/// 0 keeps all hits.
using Orientation = std::array<std::int8_t, 3>;

inline Orientation reversed(Orientation orientation) {
    for (auto& sign : orientation) sign = std::int8_t(-sign);
    return orientation;
}

/// Turns the hits of box sweeps into pairs of the caller's objects, for one share of the work.
/// Thread safety: one thread at a time.
class BoxPairMaker {
public:
    BoxPairMaker(const ScanContext& context, ShareWriter& writer)
        : context_(context), slack_(context.source.slack()), writer_(writer) {}

    /// Runs a sweep to its end.
    /// Throws: Error{cancelled}.
    void sweep(const BoxSweep& sweep, const Orientation& orientation);
    /// Passes the pairs that are still held to the writer. Must be called once at the end.
    void flush();

private:
    void drop_turned(const BoxSweep& sweep, std::span<BoxHits> hits, const Orientation& orientation);
    void drop_refused(const BoxSweep& sweep, const Depths& depths, std::span<BoxHits> hits);
    void check(const BoxSweep& sweep, std::span<const BoxHits> hits) const;
    void write(const BoxSweep& sweep, std::span<const BoxHits> hits);

    const ScanContext& context_;
    RoundingSlack slack_;
    ShareWriter& writer_;
    std::array<BoxHits, default_tuning.sweep.hits> hits_;
    std::array<BoxHits, default_tuning.sweep.hits> doubtful_;
    std::array<Pair, default_tuning.sweep.pairs + BoxHits::max_count> pairs_;
    std::size_t held_ = 0;
};

}  // namespace octopair
