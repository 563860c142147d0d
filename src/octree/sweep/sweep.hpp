// Sweep: finds the overlapping boxes of sorted sets by a sweep along one axis.
//
// A SweepSet holds boxes in the order (low bound on the axis, position), as a structure of arrays. At its end is padding that
// hits nothing. A sweep tests each row against the columns that begin within the row on the axis:
//   self          row i against the columns i + 1, i + 2, ... of the same set
//   cross         a row against the columns of another set that do not begin before the row
//   cross_strict  a row against the columns of another set that begin after the row
// One cross sweep, and one cross_strict sweep with rows and columns exchanged, find each pair of two sets once.
//
// Rows are taken in blocks of 8. A block is tested against the columns that begin within any of its rows. Hits are written as
// one bit mask over the rows for each column: block by block, columns ascending, for any width of the registers.
//
// sweep_rows_scalar is the specification. sweep_rows is its SIMD version, chosen for the processor at run time
// (sweep_kernel.cpp). PairMaker runs whole sweeps for recursive_sweep.cpp.
//
// Source: Lucchesi, Egbert, Harris 2014, section 2.3.1 (sweep and prune).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/memory.hpp"
#include "boxes/entry.hpp"
#include "octopair/objects.hpp"

namespace octopair {

class SweepSet {
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

/// Number of rows that are tested together.
inline constexpr std::size_t block_size = 8;

/// A column and the rows of one block that hit it.
class HitMask {
public:
    HitMask() = default;
    /// `first_row`: first row of the block, below 2^24. Bit k of `bits`: row first_row + k.
    HitMask(std::uint32_t column, std::size_t first_row, std::uint32_t bits)
        : column_(column), rows_(std::uint32_t(first_row) << block_size | bits) {}

    std::uint32_t column() const { return column_; }
    std::uint32_t first_row() const { return rows_ >> block_size; }
    std::uint32_t bits() const { return rows_ & ((1u << block_size) - 1); }
    /// Clears the rows that are not in `bits`.
    void keep(std::uint32_t bits) { rows_ &= bits | ~((1u << block_size) - 1); }

private:
    std::uint32_t column_;
    std::uint32_t rows_;
};

/// Position at which a sweep continues: the next block of rows, and the next column for this block. Rows before `row` are done.
struct SweepCursor {
    std::size_t row = 0;
    std::size_t column = 0;
    std::size_t first_column =
        0;                ///< cross: first column that does not begin before `row`; cross_strict: that begins after
    bool in_row = false;  ///< true if `column` is set for `row`
};

enum class SweepKind : std::uint8_t { self, cross, cross_strict };

struct Sweep {
    const SweepSet& rows;
    const SweepSet& columns;  ///< the set of rows if `kind` is `self`
    SweepKind kind;
};

/// Maximum number of columns that are tested together.
inline constexpr std::size_t max_columns = 8;

/// Continues a sweep at `cursor` and writes hits to `hits`. Returns the number of masks written. Stops early if `hits` is full
/// or after a bounded number of tests, with `cursor` at the next test. The sweep is done when cursor.row is not below the
/// number of rows.
/// Requires: `hits` has room for at least max_columns masks.
std::size_t sweep_rows(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits);

/// Specification of sweep_rows(): tests one column at a time.
std::size_t sweep_rows_scalar(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits);

/// Writes the pairs of hits, in order, as (lower object, higher object - `second_begin`). Returns the number of pairs.
/// Requires: `pairs` has room for max_hits pairs of each mask.
std::size_t pairs_of_hits(const Sweep& sweep, std::span<const HitMask> hits, std::uint32_t second_begin, Pair* pairs);
inline constexpr std::size_t max_hits = block_size;  ///< maximum number of hits of a HitMask

/// Returns a depth of overlap for each axis. A hit whose boxes overlap deeper on all axes is certain: rounding cannot have caused it.
Depths certain_depths(const Sweep& sweep, const RoundingSlack& slack);

/// Clears the hits whose boxes do not overlap by more than `depths` on all axes: deep() (boxes/entry.hpp).
void keep_deep(const Sweep& sweep, const Depths& depths, std::span<HitMask> hits);

/// Returns the instruction set that sweep_rows uses on this machine, such as "AVX2".
std::string sweep_instruction_set();
/// For tests: true allows only the baseline instruction set, false allows all.
void restrict_sweep_to_baseline(bool baseline_only);

/// Moves `cursor` to the first column of its rows, for cross and cross_strict sweeps. Called by start_rows() only.
void start_crossing_rows(const Sweep& sweep, SweepCursor& cursor);

/// Moves `cursor` to the first column of its rows, unless the cursor is there already. Shared by all versions.
inline void start_rows(const Sweep& sweep, SweepCursor& cursor) {
    if (cursor.in_row) return;
    if (sweep.kind == SweepKind::self) {
        cursor.column = cursor.row;
    } else {
        start_crossing_rows(sweep, cursor);
    }
    cursor.in_row = true;
}

}  // namespace octopair
