#include "engine/bucket_sort.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

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

static_assert(SlottedRows::read_beyond >= CountedRows::read_beyond);

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
    in_slots ? sort_in_slots(strings, bits, state) : sort_counted(strings, bits, state);
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
            counted_.write_row(slotted_.object(row), slotted_.long_row(row), bits, writer);
            continue;
        }
        writer.copy(short_rows.first(slotted_.size(row)));
        short_rows = short_rows.subspan(slotted_.size(row));
    }
}

/// Sorts pairs of rows of any length.
void BucketSort::sort_counted(const std::vector<PageString>& strings, unsigned bits, CallState& state) {
    count_path(Path::bucket_sorted);
    const auto [rows, first_row] = rows_of(strings, bits, plan_.keys());
    counted_.reset(rows, std::uint32_t(first_row));
    for (const PageString& string : strings) {
        for (std::size_t i = 0; i < string.pages().size(); ++i) counted_.count(string.page(i));
    }
    counted_.make_room();
    for (const PageString& string : strings) {
        for (std::size_t i = string.pages().size(); i-- > 0;) {  // the page returned last is taken first
            counted_.move(string.page(i));
            state.spend(string.pages()[i]);
        }
    }
    PageWriter writer(pages_, state.sorted);
    counted_.write(std::min(bits, plan_.keys().column_bits()), writer);
    writer.finish();
}

}  // namespace octopair
