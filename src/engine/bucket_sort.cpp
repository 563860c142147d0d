#include "engine/bucket_sort.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "boxes/row_sort.hpp"

namespace octopair {

BucketPlan::BucketPlan(const AscendingBounds& bounds, unsigned fillers) : keys_(bounds.rows, bounds.columns) {
    const std::uint64_t spare_pages = bounds.max_pairs / page_pairs() / 4 / fillers;
    const unsigned row_bits = keys_.row_bits();
    const unsigned for_rows = row_bits - std::min(row_bits, tuning().output.bucket_row_bits);
    const unsigned for_pairs =
        std::min(row_bits, unsigned(std::bit_width(bounds.expected / tuning().output.bucket_pairs)));
    const unsigned wanted = std::min(std::max(for_rows, for_pairs), tuning().output.bucket_bits);
    bits_ = std::clamp(wanted, 1u, unsigned(std::bit_width(spare_pages | 2)) - 1);
}

namespace {

constexpr std::size_t columns_read_beyond = 16;  // by sort_rows()
static_assert(SlottedRows::read_beyond >= columns_read_beyond);

/// Requires: the strings are not all empty.
const Pair& first_pair(const std::vector<PageString>& strings) {
    return std::ranges::find_if(strings, [](const PageString& string) { return string.size() > 0; })->page(0).front();
}

struct BucketRows {
    std::size_t count;
    std::uint64_t first;
};

/// Returns the rows of all keys that differ from those of the pairs only in their lowest `bits`.
/// Requires: the strings are not all empty.
BucketRows rows_of(const std::vector<PageString>& strings, unsigned bits, const PairKeys& keys) {
    const std::size_t count = std::size_t(1) << (bits - std::min(bits, keys.column_bits()));
    return {count, keys.first_row() + (keys.row(first_pair(strings)) & ~(count - 1))};
}

}  // namespace

/// Writes pairs to pages, and appends a run for each page.
class BucketSort::PageWriter {
public:
    PageWriter(Pages& pages, Runs& runs) : pages_(pages), runs_(runs) {}
    /// Returns the number of pairs that fit into the page, at least 1. Takes a page if there is none.
    std::size_t left() {
        if (page_ == nullptr) page_ = pages_.take();
        return page_pairs() - used_;
    }
    /// Requires: left() was called since the last pairs were written.
    Pair* next() { return page_ + used_; }
    void wrote(std::size_t pairs) {
        used_ += pairs;
        if (used_ == page_pairs()) finish();
    }
    void copy(std::span<const Pair> pairs) {
        while (!pairs.empty()) {
            const auto part = pairs.first(std::min(pairs.size(), left()));
            std::ranges::copy(part, next());
            wrote(part.size());
            pairs = pairs.subspan(part.size());
        }
    }
    void finish() {
        if (used_ > 0) runs_.emplace_back(page_, used_);
        page_ = nullptr;
        used_ = 0;
    }

private:
    Pages& pages_;
    Runs& runs_;
    Pair* page_ = nullptr;
    std::size_t used_ = 0;
};

/// State of one call of sort().
struct BucketSort::CallState {
    const std::stop_token& stop;
    Pages& pages;
    std::vector<Pair*>* spent;
    Runs sorted = {};

    void spend(Pair* page) { spent != nullptr ? spent->push_back(page) : pages.give_back(page); }
};

BucketSort::Runs BucketSort::sort(std::vector<PageString>&& strings, const std::stop_token& stop,
                                  std::vector<Pair*>* spent) {
    CallState state{stop, pages_, spent};
    sort(std::move(strings), plan_.key_bits(), state);
    return std::move(state.sorted);
}

/// Requires: the keys of all pairs differ only in their lowest `bits`.
void BucketSort::sort(std::vector<PageString>&& strings, unsigned bits, CallState& state) {
    const std::size_t size = std::size_t(pairs_in(strings));
    if (size == 0) return;
    throw_if_stopped(state.stop);
    if (size > tuning().output.sorted_at_once && bits > 0) {
        count_path(Path::bucket_split);
        return split(std::move(strings), bits, state);
    }
    const unsigned row_bits = bits - std::min(bits, plan_.keys().column_bits());
    if (size << tuning().output.sparse_row_bits >> row_bits == 0) return sort_sparse(strings, state);
    const std::size_t most_in_slots =
        std::min(tuning().output.slotted_pairs_per_row << row_bits, SlottedRows::max_pairs);
    const bool in_slots = row_bits <= tuning().output.max_slotted_row_bits && size <= most_in_slots;
    in_slots ? sort_in_slots(strings, bits, state) : sort_rows_at_once(strings, bits, state);
}

void BucketSort::split(std::vector<PageString>&& strings, unsigned bits, CallState& state) {
    const unsigned low_bits = bits - std::min(bits, tuning().output.bucket_split_bits);
    std::vector<PageString> parts(std::size_t(1) << tuning().output.bucket_split_bits);
    for (const PageString& string : strings) {
        for (std::size_t i = 0; i < string.pages().size(); ++i) {
            throw_if_stopped(state.stop);
            for (const Pair& pair : string.page(i)) {
                parts[plan_.keys().key(pair) >> low_bits & (parts.size() - 1)].add(pair, pages_);
            }
            state.spend(string.pages()[i]);
        }
    }
    strings.clear();
    for (PageString& part : parts) {
        std::vector<PageString> one;
        one.push_back(std::move(part));
        sort(std::move(one), low_bits, state);
    }
}

/// Sorts pairs that are few for their number of rows: most rows are empty.
void BucketSort::sort_sparse(const std::vector<PageString>& strings, CallState& state) {
    count_path(Path::sparse_bucket_sorted);
    sparse_.clear();
    for (const PageString& string : strings) {
        for (std::size_t i = 0; i < string.pages().size(); ++i) {
            sparse_.insert(sparse_.end(), string.page(i).begin(), string.page(i).end());
            state.spend(string.pages()[i]);
        }
    }
    std::ranges::sort(sparse_, {}, [&](const Pair& pair) { return plan_.keys().key(pair); });
    PageWriter writer(pages_, state.sorted);
    writer.copy(sparse_);
    writer.finish();
}

/// Sorts pairs of rows that mostly have few pairs.
void BucketSort::sort_in_slots(const std::vector<PageString>& strings, unsigned bits, CallState& state) {
    count_path(Path::bucket_in_slots);
    const PairKeys& keys = plan_.keys();
    const auto [rows, first_row] = rows_of(strings, bits, keys);
    slotted_.reset(rows, std::size_t(pairs_in(strings)), std::uint32_t(first_row));
    for (const PageString& string : strings) {
        for (std::size_t i = string.pages().size(); i-- > 0;) {  // the page returned last is taken first
            slotted_.add(string.page(i), i > 0 ? string.page(i - 1) : std::span<Pair>());
            state.spend(string.pages()[i]);
        }
    }
    slotted_.collect_long_rows();
    PageWriter writer(pages_, state.sorted);
    for (std::size_t row = 0; row < rows; row += row_group)
        write_group(row, std::min(bits, keys.column_bits()), writer);
    writer.finish();
}

/// Sorts the columns of a group of slotted rows and writes the pairs to pages. `bits`: number of low bits in which columns differ.
void BucketSort::write_group(std::size_t first_row, unsigned bits, PageWriter& writer) {
    const RowGroup group = slotted_.group(first_row);
    std::uint32_t pairs = 0;
    bool any_long = false;
    for (std::size_t row = 0; row < row_group; ++row) {
        pairs += group.counts[row];
        any_long |= group.counts[row] > row_slots;
    }
    if (pairs == 0) return;
    if (!any_long && writer.left() >= pairs + row_slots) {
        count_path(Path::slotted_rows_in_page);
        sort_group(group, writer.next());
        return writer.wrote(pairs);
    }
    staged_.resize((row_group + 1) * row_slots);
    sort_group(group, staged_.data());
    count_path(any_long ? Path::slots_exceeded : Path::slotted_rows_staged);
    if (!any_long) return writer.copy(std::span(staged_).first(pairs));
    std::span<const Pair> short_rows = staged_;
    for (std::size_t row = first_row; row < std::min(first_row + row_group, slotted_.rows()); ++row) {
        if (slotted_.is_long(row)) {
            write_long_row(row, bits, writer);
            continue;
        }
        writer.copy(short_rows.first(slotted_.size(row)));
        short_rows = short_rows.subspan(slotted_.size(row));
    }
}

/// Sorts the columns of a slotted row with more pairs than slots, and writes the pairs to pages.
void BucketSort::write_long_row(std::size_t row, unsigned bits, PageWriter& writer) {
    const std::span<const std::uint32_t> columns = slotted_.long_row(row);
    if (columns.size() > max_row_at_once || columns.size() > writer.left()) {
        return write_row(slotted_.object(row), columns, bits, writer);
    }
    const auto end = std::uint32_t(columns.size());
    sort_rows({columns.data(), 0, {&end, 1}, slotted_.object(row)}, writer.next());
    writer.wrote(end);
}

void BucketSort::sort_rows_at_once(const std::vector<PageString>& strings, unsigned bits, CallState& state) {
    count_path(Path::bucket_sorted);
    const PairKeys& keys = plan_.keys();
    const auto [rows, first_row] = rows_of(strings, bits, keys);
    const auto row_of = [&, row_bits = std::uint32_t(rows - 1)](const Pair& pair) { return keys.row(pair) & row_bits; };
    row_ends_.assign(2 * rows, 0);
    const std::span<std::uint32_t> ends = std::span(row_ends_).first(rows),
                                   odd_counts = std::span(row_ends_).subspan(rows);
    for (const PageString& string : strings) {
        for (std::size_t i = 0; i < string.pages().size(); ++i) {
            const std::span<const Pair> page = string.page(i);
            // Two counters for each row: a counter cannot be read again before its last store is done.
            std::size_t k = 0;
            for (; k + 1 < page.size(); k += 2) {
                ++ends[row_of(page[k])];
                ++odd_counts[row_of(page[k + 1])];
            }
            if (k < page.size()) ++ends[row_of(page[k])];
        }
    }
    std::uint32_t begin = 0, longest = 0;
    for (std::size_t row = 0; row < rows; ++row) {
        const std::uint32_t size = ends[row] + odd_counts[row];
        longest = std::max(longest, size);
        ends[row] = std::exchange(begin, begin + size);
    }
    const bool long_runs = longest > begin / 4;  // pairs of one row often follow each other if the row is long
    columns_.resize_discard(begin + columns_read_beyond);
    for (const PageString& string : strings) {
        for (std::size_t i = string.pages().size(); i-- > 0;) {  // the page returned last is taken first
            const std::span<const Pair> page = string.page(i);
            if (!long_runs) {
                for (const Pair& pair : page) columns_[ends[row_of(pair)]++] = pair.b;
            }
            for (std::size_t k = long_runs ? 0 : page.size(); k < page.size();) {
                const std::uint32_t row = row_of(page[k]);
                std::uint32_t at = ends[row];
                do columns_[at++] = page[k++].b;
                while (k < page.size() && row_of(page[k]) == row);
                ends[row] = at;
            }
            state.spend(string.pages()[i]);
        }
    }
    write_rows({ends, first_row}, std::min(bits, keys.column_bits()), state);
}

/// Sorts the columns of each row and writes the pairs to pages.
void BucketSort::write_rows(const Rows& rows, unsigned bits, CallState& state) {
    PageWriter writer(pages_, state.sorted);
    std::uint32_t begin = 0;
    for (std::size_t row = 0; begin < rows.ends.back();) {
        // As many rows as fit into the page. Without any, a single row, which is long or goes beyond the page.
        const std::uint32_t page_end = begin + std::uint32_t(writer.left());
        std::size_t end = row;
        for (std::uint32_t at = begin; end < rows.ends.size(); at = rows.ends[end++]) {
            if (rows.ends[end] > page_end || rows.ends[end] - at > max_row_at_once) break;
        }
        if (end > row) {
            const auto ends = rows.ends.subspan(row, end - row);
            sort_rows({columns_.data(), begin, ends, std::uint32_t(rows.first + row)}, writer.next());
            writer.wrote(ends.back() - begin);
        } else {
            end = row + 1;
            write_row(std::uint32_t(rows.first + row), columns_.span().subspan(begin, rows.ends[row] - begin), bits,
                      writer);
        }
        begin = rows.ends[end - 1];
        row = end;
    }
    writer.finish();
}

void BucketSort::write_row(std::uint32_t row, std::span<const std::uint32_t> columns, unsigned bits,
                           PageWriter& writer) {
    count_path(Path::long_row_sorted);
    for (auto sorted = sorted_columns(columns, bits); !sorted.empty();) {
        const auto part = sorted.first(std::min(sorted.size(), writer.left()));
        Pair* const out = writer.next();
        for (std::size_t i = 0; i < part.size(); ++i) out[i] = {row, part[i]};
        writer.wrote(part.size());
        sorted = sorted.subspan(part.size());
    }
}

/// Sorts the columns of one row, which differ only in their lowest `bits`. The result is valid until the next call.
std::span<const std::uint32_t> BucketSort::sorted_columns(std::span<const std::uint32_t> columns, unsigned bits) {
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
void BucketSort::mark_columns(std::span<const std::uint32_t> columns, std::uint32_t least, std::uint32_t greatest) {
    bitmap_.assign((greatest - least) / 64 + 1, 0);
    for (const std::uint32_t column : columns)
        bitmap_[(column - least) / 64] |= std::uint64_t(1) << (column - least) % 64;
}

/// Writes the columns of the bit map in ascending order. Returns their number.
std::size_t BucketSort::read_marks(std::uint32_t least, std::uint32_t* columns) const {
    const std::uint32_t* const begin = columns;
    for (std::size_t word = 0; word < bitmap_.size(); ++word) {
        const std::uint32_t first = least + std::uint32_t(word * 64);
        for (std::uint64_t set = bitmap_[word]; set != 0; set &= set - 1)
            *columns++ = first + std::uint32_t(std::countr_zero(set));
    }
    return std::size_t(columns - begin);
}

}  // namespace octopair
