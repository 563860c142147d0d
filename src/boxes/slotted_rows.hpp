// SlottedRows: sorts the pairs of a bucket whose rows are mostly short. A row is all pairs with the same first object.
//
// 1. One pass over the pairs puts the second objects of each row into its 16 slots. If a row has more, the others go to a list.
// 2. The rows of a SIMD register are sorted together, by a sorting network over their slots, and written as pairs.
//
// The slots of a row are a cache line. Rows are sorted and written in groups of 16.
//
// sort_group_scalar() is the specification of the SIMD version.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Rows of a group, and slots of a row.
inline constexpr std::size_t row_group = 16, row_slots = 16;

/// A group of rows. A row with more pairs than slots is long.
struct RowGroup {
    const std::uint32_t* slots;   ///< slot s of row r: row_slots * r + s
    const std::uint16_t* counts;  ///< number of pairs of each row
    std::uint32_t first_object;   ///< first object of the pairs of row 0; later rows count up from it
};

/// Sorts the second objects of each row that is not long, and writes the pairs, row after row. May write `row_slots` pairs behind them.
void sort_group(const RowGroup& group, Pair* out);
void sort_group_scalar(const RowGroup& group, Pair* out);

/// Thread safety: one thread at a time.
class SlottedRows {
public:
    /// Maximum number of pairs in all rows.
    static constexpr std::size_t max_pairs = 0xFFFF;

    /// Removes all pairs. `rows`: number of rows, a power of two; `first_object`: first object of the pairs of row 0.
    /// Requires: at most `pairs` pairs are added, and not more than max_pairs.
    void reset(std::size_t rows, std::size_t pairs, std::uint32_t first_object);
    /// Adds pairs to the rows of their first objects. `next`: the pairs that the next call adds, which are prefetched.
    void add(std::span<const Pair> pairs, std::span<const Pair> next);
    /// Must be called after the last pairs are added.
    void collect_long_rows();

    std::size_t rows() const { return rows_; }
    std::uint32_t object(std::size_t row) const { return first_object_ + std::uint32_t(row); }
    /// Number of pairs of a row.
    std::size_t size(std::size_t row) const { return counts_[row]; }
    bool is_long(std::size_t row) const { return size(row) > row_slots; }
    RowGroup group(std::size_t first_row) const {
        return {slots_.data() + row_slots * first_row, counts_.data() + first_row, object(first_row)};
    }
    /// Returns the second objects of a long row, not sorted. `read_beyond` more numbers can be read behind them.
    std::span<const std::uint32_t> long_row(std::size_t row) const;
    static constexpr std::size_t read_beyond = 16;

private:
    std::size_t rows_ = 0;
    std::uint32_t first_object_ = 0;
    Buffer<std::uint32_t> slots_;
    std::vector<std::uint16_t> counts_;  // by row; 0 for rows that only complete the last group
    Buffer<std::uint64_t> spilled_;      // row and, below it, second object
    std::size_t spilled_size_ = 0;
    Buffer<std::uint32_t> long_rows_;       // second objects of long rows, row by row
    std::vector<std::uint32_t> long_ends_;  // by row: position in long_rows_ behind its last object; only of long rows
};

}  // namespace octopair
