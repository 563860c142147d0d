// Sweep: finds the overlapping boxes of sorted sets by passing along one axis.
//
// A SweepSet holds boxes in the order (low bound on the axis, object), as a structure of arrays padded with boxes that
// no box reaches. A sweep tests each row against the columns that begin within it on the axis:
//   self   row i against the columns i + 1, i + 2, ... of the same set
//   cross  row against the columns of another set that do not begin before it (`strict`: that begin after it); crossing
//          both ways, once strictly, finds each pair of two sets once
// Rows are taken in blocks of 8, which pass together over the columns that begin within one of them. Hits come out as a
// bit mask over the rows for each column: block by block, columns ascending, whatever the width of the registers.
//
// Three layers: sweep_rows_scalar is the specification; sweep_rows is its SIMD version, chosen for the processor at run
// time (sweep_kernel.cpp); the drivers are in scan.cpp. Source: the sweep and prune of the paper's section 2.3.1.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/memory.hpp"
#include "boxes/entry.hpp"
#include "octopair/objects.hpp"
#include "octree/sweep/sort_key.hpp"

namespace octopair {

class SweepSet {
public:
    static constexpr std::size_t padding = 32;  // columns that may be read beyond the end

    /// Takes the entries at the keys' positions, in that order; `axis` is the one that the keys were made for.
    void assign(std::span<const Entry> entries, std::span<const SortKey> order, unsigned axis);

    std::size_t size() const { return size_; }
    /// Bounds on the sweep's axis (0) and the two others (1, 2).
    const float* low(unsigned axis) const { return numbers_.data() + axis * stride_; }
    const float* high(unsigned axis) const { return numbers_.data() + (3 + axis) * stride_; }
    const std::uint32_t* mask() const { return words_.data(); }
    const std::uint32_t* object() const { return words_.data() + stride_; }
    /// The coordinate that low(k) and high(k) are bounds on.
    unsigned axis(unsigned k) const { return axes_[k]; }
    /// The box as it was put in.
    Entry entry(std::size_t i) const;

private:
    Buffer<float> numbers_;
    Buffer<std::uint32_t> words_;
    std::size_t size_ = 0;
    std::size_t stride_ = 0;
    std::array<unsigned, 3> axes_ = {0, 1, 2};
};

/// Where the numbers of an Entry go, in its order.
using EntryArrays = std::array<std::uint32_t*, sizeof(Entry) / sizeof(std::uint32_t)>;

/// Writes the numbers of the entries at the keys' positions to arrays, each aligned to 16 bytes and with room for 3 more.
void split_entries(std::span<const Entry> entries, std::span<const SortKey> order, const EntryArrays& arrays);

/// Rows that are tested together.
inline constexpr std::size_t block_size = 8;

/// A column and the rows of one block that hit it.
class HitMask {
public:
    HitMask() = default;
    /// `first_row`: of the block, below 2^24; bit k of `bits`: row first_row + k.
    HitMask(std::uint32_t column, std::size_t first_row, std::uint32_t bits)
        : column_(column), rows_(std::uint32_t(first_row) << block_size | bits) {}

    std::uint32_t column() const { return column_; }
    std::uint32_t first_row() const { return rows_ >> block_size; }
    std::uint32_t bits() const { return rows_ & ((1u << block_size) - 1); }
    void keep(std::uint32_t bits) { rows_ &= bits | ~((1u << block_size) - 1); }

private:
    std::uint32_t column_;
    std::uint32_t rows_;
};

/// Where a sweep stands: the next block of rows, and the next column for it. Rows before `row` are done.
struct SweepCursor {
    std::size_t row = 0;
    std::size_t column = 0;
    std::size_t first_column = 0;  // cross: the first column that does not begin before `row`
    bool in_row = false;           // `column` is set for `row`
};

enum class SweepKind : std::uint8_t { self, cross, cross_strict };

struct Sweep {
    const SweepSet& rows;
    const SweepSet& columns;  ///< self: the same set
    SweepKind kind;
};

/// Columns that are tested together, at most.
inline constexpr std::size_t most_columns = 8;

/// Fills `hits`, with room for at least most_columns, from the cursor on; returns how many masks it wrote. It stops early
/// when `hits` is full or after a bounded number of tests, with the cursor where it stopped; done when cursor.row reaches
/// the rows' end.
std::size_t sweep_rows(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits);

/// The specification: the same contract, a column at a time.
std::size_t sweep_rows_scalar(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits);

/// Writes the pairs of hits, in order, as (lower object, higher object - `second_begin`); returns how many. `pairs` must
/// have room for `most_hits` of each mask.
std::size_t pairs_of_hits(const Sweep& sweep, std::span<const HitMask> hits, std::uint32_t second_begin, Pair* pairs);
inline constexpr std::size_t most_hits = block_size;  // of a HitMask

/// How deep a hit of the sweep must be, so that rounding cannot have made it.
Depths certain_depths(const Sweep& sweep, const RoundingSlack& slack);

/// Keeps of each mask the hits that are deep() (entry.hpp).
void keep_deep(const Sweep& sweep, const Depths& depths, std::span<HitMask> hits);

/// The instruction set that sweep_rows uses here, such as "AVX2".
std::string sweep_instruction_set();
/// For tests: allows only the baseline instruction set (or again all).
void restrict_sweep_to_baseline(bool baseline_only);

void start_crossing_rows(const Sweep& sweep, SweepCursor& cursor);

/// Moves `cursor` to the columns of its rows, if it is not there yet. Shared by all versions.
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
