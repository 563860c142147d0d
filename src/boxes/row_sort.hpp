// Sorts the pairs of rows: a row is all pairs with the same first object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "octopair/objects.hpp"

namespace octopair {

inline constexpr std::size_t max_row_at_once = 32;  ///< maximum number of pairs of a row for sort_rows()

/// The second objects of the pairs in consecutive rows.
struct PairRows {
    const std::uint32_t* seconds;
    std::uint32_t begin;                  ///< position in `seconds` of the first row's first object
    std::span<const std::uint32_t> ends;  ///< for each row, position in `seconds` behind its last object
    std::uint32_t first_object;           ///< first object of all pairs in the first row; later rows count up from it
};

/// Sorts the second objects of each row, and writes the pairs of all rows to `out`, row after row.
/// Requires: a row has at most max_row_at_once objects; 16 more objects behind the last row can be read.
/// Complexity: quadratic in the length of a row, divided by 8.
void sort_rows(const PairRows& rows, Pair* out);
/// Specification of sort_rows().
void sort_rows_scalar(const PairRows& rows, Pair* out);

}  // namespace octopair
