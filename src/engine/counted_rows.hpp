// CountedRows: sorts the pairs of a bucket whose rows may have any length. A row is all pairs with the same first object `a`. The
// columns of a row are the second objects `b` of its pairs.
//
// 1. A pass over the pairs counts the pairs of each row.
// 2. A second pass moves the columns to their rows.
// 3. The columns of each row are sorted, and the pairs are written to pages: short rows together (boxes/row_sort.hpp), as many as fit into
//    the page; each long row alone, by a bit map of its columns or a radix sort.
//
// Step 3 alone also sorts a row that was collected elsewhere: the long rows of a bucket in slots (boxes/slotted_rows.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "base/radix_sort.hpp"
#include "engine/pair_pages.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Keeps its memory for the next bucket.
/// Thread safety: one thread at a time.
class CountedRows {
public:
    /// Removes all pairs. `rows`: number of rows, a power of two; `first_object`: first object of the pairs of row 0.
    void reset(std::size_t rows, std::uint32_t first_object);
    /// Counts the pairs of each row.
    void count(std::span<const Pair> pairs);
    /// Must be called after the last pairs are counted, and before the first are moved.
    void make_room();
    /// Moves the columns of pairs to their rows. Requires: the pairs were counted.
    void move(std::span<const Pair> pairs);
    /// Sorts the columns of each row and writes the pairs to pages. `bits`: number of low bits in which columns of a row differ.
    /// Requires: all counted pairs were moved.
    void write(unsigned bits, PageWriter& writer);

    /// Sorts the columns of one row, whose first object is `object`, and writes the pairs to pages. Independent of the other functions.
    /// Requires: the columns differ only in their lowest `bits`; `read_beyond` more numbers can be read behind them.
    void write_row(std::uint32_t object, std::span<const std::uint32_t> columns, unsigned bits, PageWriter& writer);
    static constexpr std::size_t read_beyond = 16;  // as sort_rows() reads

private:
    void write_long_row(std::uint32_t object, std::span<const std::uint32_t> columns, unsigned bits,
                        PageWriter& writer);
    std::span<const std::uint32_t> sorted_columns(std::span<const std::uint32_t> columns, unsigned bits);
    void mark_columns(std::span<const std::uint32_t> columns, std::uint32_t least, std::uint32_t greatest);
    std::size_t read_marks(std::uint32_t least, std::uint32_t* columns) const;

    /// Returns the row of a pair. Loops use a copy, so that the compiler can keep it in registers.
    struct RowOf {
        std::uint32_t first_object = 0, last_row = 0;
        std::uint32_t operator()(const Pair& pair) const { return (pair.a - first_object) & last_row; }
    };

    std::size_t rows_ = 0;
    RowOf row_of_;
    bool long_runs_ = false;               // move() moves runs of pairs of one row
    Buffer<std::uint32_t> columns_;        // row by row
    std::vector<std::uint32_t> row_ends_;  // by row: position behind its last column; then second counters
    std::vector<std::uint64_t> bitmap_;    // columns of a long row
    RadixSort<std::uint32_t> radix_;       // sorts a long row
};

}  // namespace octopair
