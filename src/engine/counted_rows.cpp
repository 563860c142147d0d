#include "engine/counted_rows.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "boxes/row_sort.hpp"

namespace octopair {

void CountedRows::reset(std::size_t rows, std::uint32_t first_object) {
    rows_ = rows;
    row_of_ = {first_object, std::uint32_t(rows - 1)};
    row_ends_.assign(2 * rows, 0);
}

void CountedRows::count(std::span<const Pair> pairs) {
    const RowOf row_of = row_of_;
    std::uint32_t *const counts = row_ends_.data(), *const odd_counts = counts + rows_;
    // Two counters for each row: a counter cannot be read again before its last store is done.
    std::size_t k = 0;
    for (; k + 1 < pairs.size(); k += 2) {
        ++counts[row_of(pairs[k])];
        ++odd_counts[row_of(pairs[k + 1])];
    }
    if (k < pairs.size()) ++counts[row_of(pairs[k])];
}

void CountedRows::make_room() {
    const std::span<std::uint32_t> ends = std::span(row_ends_).first(rows_),
                                   odd_counts = std::span(row_ends_).subspan(rows_);
    std::uint32_t begin = 0, longest = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
        const std::uint32_t size = ends[row] + odd_counts[row];
        longest = std::max(longest, size);
        ends[row] = std::exchange(begin, begin + size);
    }
    long_runs_ = longest > begin / 4;  // pairs of one row often follow each other if the row is long
    columns_.resize_discard(begin + read_beyond);
}

void CountedRows::move(std::span<const Pair> pairs) {
    const RowOf row_of = row_of_;
    std::uint32_t *const columns = columns_.data(), *const ends = row_ends_.data();
    if (!long_runs_) {
        for (const Pair& pair : pairs) columns[ends[row_of(pair)]++] = pair.b;
        return;
    }
    for (std::size_t k = 0; k < pairs.size();) {
        const std::uint32_t row = row_of(pairs[k]);
        std::uint32_t at = ends[row];
        do columns[at++] = pairs[k++].b;
        while (k < pairs.size() && row_of(pairs[k]) == row);
        ends[row] = at;
    }
}

void CountedRows::write(unsigned bits, PageWriter& writer) {
    const std::span<const std::uint32_t> all_ends = std::span(row_ends_).first(rows_);
    std::uint32_t begin = 0;
    for (std::size_t row = 0; begin < all_ends.back();) {
        // As many rows as fit into the page. Without any, a single row, which is long or goes beyond the page.
        const std::uint32_t page_end = begin + std::uint32_t(writer.left());
        std::size_t end = row;
        for (std::uint32_t at = begin; end < rows_; at = all_ends[end++]) {
            if (all_ends[end] > page_end || all_ends[end] - at > max_row_at_once) break;
        }
        const std::uint32_t object = row_of_.first_object + std::uint32_t(row);
        if (end > row) {
            const auto ends = all_ends.subspan(row, end - row);
            sort_rows({columns_.data(), begin, ends, object}, writer.next());
            writer.wrote(ends.back() - begin);
        } else {
            end = row + 1;
            write_long_row(object, columns_.span().subspan(begin, all_ends[row] - begin), bits, writer);
        }
        begin = all_ends[end - 1];
        row = end;
    }
}

void CountedRows::write_row(std::uint32_t object, std::span<const std::uint32_t> columns, unsigned bits,
                            PageWriter& writer) {
    if (columns.size() > max_row_at_once || columns.size() > writer.left()) {
        return write_long_row(object, columns, bits, writer);
    }
    const auto end = std::uint32_t(columns.size());
    sort_rows({columns.data(), 0, {&end, 1}, object}, writer.next());
    writer.wrote(end);
}

/// Does what write_row() does, also for a row that is too long for sort_rows() or goes beyond the page.
void CountedRows::write_long_row(std::uint32_t object, std::span<const std::uint32_t> columns, unsigned bits,
                                 PageWriter& writer) {
    count_path(Path::long_row_sorted);
    for (auto sorted = sorted_columns(columns, bits); !sorted.empty();) {
        const auto part = sorted.first(std::min(sorted.size(), writer.left()));
        Pair* const out = writer.next();
        for (std::size_t i = 0; i < part.size(); ++i) out[i] = {object, part[i]};
        writer.wrote(part.size());
        sorted = sorted.subspan(part.size());
    }
}

/// Sorts the columns of one row, which differ only in their lowest `bits`. The result is valid until the next call.
std::span<const std::uint32_t> CountedRows::sorted_columns(std::span<const std::uint32_t> columns, unsigned bits) {
    const std::span<std::uint32_t> sorted = radix_.take(columns.size());
    const auto [least, greatest] = std::ranges::minmax(columns);
    if ((greatest - least) / tuning().output.bitmap_columns < columns.size()) {
        count_path(Path::row_in_bitmap);
        mark_columns(columns, least, greatest);
        if (read_marks(least, sorted.data()) == columns.size()) return sorted;
        // The row has a pair twice, which only a fault elsewhere can cause. Both are kept, so that a check can find them.
    }
    std::ranges::copy(columns, sorted.begin());
    return radix_.sort(0, bits);
}

/// Sets the bits of the columns in the bit map. Its first bit is that of column `least`.
void CountedRows::mark_columns(std::span<const std::uint32_t> columns, std::uint32_t least, std::uint32_t greatest) {
    bitmap_.assign((greatest - least) / 64 + 1, 0);
    for (const std::uint32_t column : columns)
        bitmap_[(column - least) / 64] |= std::uint64_t(1) << (column - least) % 64;
}

/// Writes the columns of the bit map in ascending order. Returns their number.
std::size_t CountedRows::read_marks(std::uint32_t least, std::uint32_t* columns) const {
    const std::uint32_t* const begin = columns;
    for (std::size_t word = 0; word < bitmap_.size(); ++word) {
        const std::uint32_t first = least + std::uint32_t(word * 64);
        for (std::uint64_t set = bitmap_[word]; set != 0; set &= set - 1)
            *columns++ = first + std::uint32_t(std::countr_zero(set));
    }
    return std::size_t(columns - begin);
}

}  // namespace octopair
