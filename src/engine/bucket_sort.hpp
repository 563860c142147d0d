// BucketSort: sorts pairs into ascending order (by a, then b) with one bucket for each range of neighbouring `a`.
//
// 1. Each thread or worker scatters the pairs that it finds into its own buckets. A bucket is a PageString: an array of pairs that grows
//    by pages, which have a fixed size and later form a list.
// 2. Each bucket is gathered from all threads or workers and sorted independently, by one of three ways:
//      few pairs for its rows   the pairs are sorted as they are
//      mostly short rows        the objects `b` of a row are put into slots, and sorted by networks (boxes/slotted_rows.hpp)
//      otherwise                pairs are counted by `a` and moved to their rows, then the objects `b` of each row are sorted
//
// Invariants
//   Every key in bucket i is less than every key in bucket i + 1.
//   The sorted result does not depend on which thread or worker found a pair.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "base/memory.hpp"
#include "base/radix_sort.hpp"
#include "base/tuning.hpp"
#include "boxes/slotted_rows.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Returns the capacity of a page in pairs.
inline std::size_t page_pairs() { return tuning().output.page; }

/// Thrown by a pass that needs more pages than its budget allows. At most a quarter of its pages are then partly filled.
struct OverBudget {};

/// Number of pages that all threads or workers of a pass together may still take. Also counts the pages that one thread or worker took.
/// Thread safety: any thread.
class PageBudget {
public:
    /// Borrows both numbers, which may be in shared memory.
    PageBudget(std::atomic<std::int64_t>& left, std::atomic<std::uint64_t>& taken) : left_(&left), taken_(&taken) {}

    /// Throws: OverBudget.
    void take_page() {
        if (ended_) return;
        taken_->fetch_add(1);
        if (left_->fetch_sub(1) <= 0) throw OverBudget{};
    }
    std::uint64_t taken() const { return taken_->load(); }
    /// Sets the number of pages that were taken, and returns the difference to the pages that are left.
    void restore(std::uint64_t taken) { left_->fetch_add(std::int64_t(taken_->exchange(taken) - taken)); }
    /// From now on, pages are not limited: sorting a bucket takes more pages than it returns, if the bucket is split.
    void end() { ended_ = true; }

private:
    std::atomic<std::int64_t>* left_;
    std::atomic<std::uint64_t>* taken_;
    bool ended_ = false;
};

/// Page allocator of one thread or worker, with a free list.
class Pages {
public:
    /// `next_block` returns memory for at least one page. Borrows the budget.
    Pages(std::function<std::span<Pair>()> next_block, PageBudget& budget)
        : next_block_(std::move(next_block)), budget_(budget) {}

    /// Throws: OverBudget.
    Pair* take() {
        if (returned_.empty()) return fresh();
        Pair* page = returned_.back();
        returned_.pop_back();
        return page;
    }
    void give_back(Pair* page) { returned_.push_back(page); }

private:
    Pair* fresh() {
        budget_.take_page();
        if (block_.size() < page_pairs()) block_ = next_block_();
        Pair* const page = block_.data();
        block_ = block_.subspan(page_pairs());
        return page;
    }

    std::function<std::span<Pair>()> next_block_;
    PageBudget& budget_;
    std::span<Pair> block_;
    std::vector<Pair*> returned_;
};

/// A growing array of pairs in pages. All pages but the last are full.
class PageString {
public:
    PageString() = default;
    /// Requires: `pages` is exactly as long as `size` pairs need.
    PageString(std::vector<Pair*> pages, std::size_t size) : pages_(std::move(pages)) {
        if (pages_.empty()) return;
        end_ = pages_.back() + page_pairs();
        next_ = end_ - (pages_.size() * page_pairs() - size);
    }

    void add(const Pair& pair, Pages& pages) {
        if (next_ == end_) grow(pages);
        prefetch(next_ + prefetched);
        *next_++ = pair;
    }

    std::size_t size() const { return pages_.size() * page_pairs() - std::size_t(end_ - next_); }
    std::span<Pair* const> pages() const { return pages_; }
    std::span<Pair> page(std::size_t i) const { return {pages_[i], std::min(page_pairs(), size() - i * page_pairs())}; }

private:
    static constexpr std::size_t prefetched = 12;  // pairs: the cache line after the current one

    void grow(Pages& pages) {
        next_ = pages.take();
        end_ = next_ + page_pairs();
        pages_.push_back(next_);
    }

    std::vector<Pair*> pages_;
    Pair* next_ = nullptr;
    Pair* end_ = nullptr;
};

/// Returns the number of pairs in all strings.
inline std::uint64_t pairs_in(std::span<const PageString> strings) {
    std::uint64_t pairs = 0;
    for (const PageString& string : strings) pairs += string.size();
    return pairs;
}

/// Takes the strings of one bucket from the buckets of all threads or workers.
inline std::vector<PageString> take_bucket(std::span<std::vector<PageString>> of_fillers, std::size_t bucket) {
    std::vector<PageString> strings;
    strings.reserve(of_fillers.size());
    for (auto& buckets : of_fillers) strings.push_back(std::exchange(buckets[bucket], {}));
    return strings;
}

/// Objects [begin, end).
struct ObjectRange {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
};

/// The parameters of a pass that finds pairs in ascending order.
struct AscendingBounds {
    ObjectRange rows;                                 ///< range of `a`; pairs with another `a` are skipped
    std::uint64_t columns = 0;                        ///< upper bound on `b`: every b < columns
    std::uint64_t max_pairs = ~std::uint64_t(0) / 2;  ///< capacity of all pages together, in pairs
    std::uint64_t expected = 0;                       ///< expected number of pairs; 0: unknown
};

/// Maps pairs to integer keys in ascending order of pairs. Keys have only the bits that the rows and columns need.
class PairKeys {
public:
    PairKeys(ObjectRange rows, std::uint64_t columns)
        : first_(rows.begin), count_(rows.end - rows.begin), b_bits_(unsigned(std::bit_width(columns))) {}

    /// Returns true if `pair.a` is in the range of rows.
    bool wanted(const Pair& pair) const { return pair.a - first_ < count_; }
    /// Returns the row of a pair, relative to the first row.
    std::uint32_t row(const Pair& pair) const { return std::uint32_t(pair.a - first_); }
    std::uint64_t first_row() const { return first_; }
    std::uint64_t key(const Pair& pair) const { return (pair.a - first_) << b_bits_ | pair.b; }
    unsigned row_bits() const { return std::max(1u, unsigned(std::bit_width(count_))); }
    unsigned column_bits() const { return b_bits_; }
    unsigned bits() const { return row_bits() + b_bits_; }

private:
    std::uint64_t first_, count_;
    unsigned b_bits_;
};

/// Assigns pairs to buckets. The assignment depends only on the constructor's arguments.
class BucketPlan {
public:
    /// `fillers`: number of threads or workers, each of which fills its own buckets.
    BucketPlan(const AscendingBounds& bounds, unsigned fillers);

    static constexpr unsigned max_bits = default_tuning.output.bucket_bits;
    const PairKeys& keys() const { return keys_; }
    std::size_t buckets() const { return std::size_t(1) << bits_; }
    std::size_t bucket(const Pair& pair) const { return std::size_t(keys_.key(pair) >> key_bits()); }
    /// Number of low key bits in which the pairs of one bucket differ.
    unsigned key_bits() const { return keys_.bits() - bits_; }

    /// Appends each wanted pair to the string of its bucket. `strings` has one string for each bucket.
    /// Throws: OverBudget.
    void fill(std::span<const Pair> pairs, std::span<PageString> strings, Pages& pages) const {
        if (key_bits() < keys_.column_bits()) {
            for (const Pair& pair : pairs) {
                if (keys_.wanted(pair)) strings[bucket(pair)].add(pair, pages);
            }
            return;
        }
        const unsigned rows_in_bucket = key_bits() - keys_.column_bits();  // log2
        for (const Pair& pair : pairs) {
            if (keys_.wanted(pair)) strings[keys_.row(pair) >> rows_in_bucket].add(pair, pages);
        }
    }

private:
    PairKeys keys_;
    unsigned bits_;
};

/// Sorts the pairs of one bucket at a time. Keeps its memory for the next bucket.
/// Thread safety: one thread at a time.
class BucketSort {
public:
    using Runs = std::vector<std::span<const Pair>>;
    BucketSort(const BucketPlan& plan, Pages& pages) : plan_(plan), pages_(pages) {}

    /// Returns the sorted pairs as runs in pages. Each input page returns to the pages' free list as soon as it is read. If
    /// `spent` is not null, the input pages are appended to it unchanged instead.
    /// Throws: Error{cancelled}, OverBudget.
    Runs sort(std::vector<PageString>&& strings, const std::stop_token& stop, std::vector<Pair*>* spent = nullptr);

private:
    struct CallState;
    void sort(std::vector<PageString>&& strings, unsigned bits, CallState& state);
    void split(std::vector<PageString>&& strings, unsigned bits, CallState& state);
    class PageWriter;
    /// Rows of a bucket: positions behind their last columns in `columns_`, and the object `a` of the first row.
    struct Rows {
        std::span<const std::uint32_t> ends;
        std::uint64_t first;
    };
    void sort_sparse(const std::vector<PageString>& strings, CallState& state);
    void sort_in_slots(const std::vector<PageString>& strings, unsigned bits, CallState& state);
    void write_group(std::size_t first_row, unsigned bits, PageWriter& writer);
    void write_long_row(std::size_t row, unsigned bits, PageWriter& writer);
    void sort_rows_at_once(const std::vector<PageString>& strings, unsigned bits, CallState& state);
    void write_rows(const Rows& rows, unsigned bits, CallState& state);
    void write_row(std::uint32_t row, std::span<const std::uint32_t> columns, unsigned bits, PageWriter& writer);
    std::span<const std::uint32_t> sorted_columns(std::span<const std::uint32_t> columns, unsigned bits);
    void mark_columns(std::span<const std::uint32_t> columns, std::uint32_t least, std::uint32_t greatest);
    std::size_t read_marks(std::uint32_t least, std::uint32_t* columns) const;

    const BucketPlan& plan_;
    Pages& pages_;
    std::vector<Pair> sparse_;             // pairs of a bucket with many empty rows
    SlottedRows slotted_;                  // pairs of a bucket with short rows
    std::vector<Pair> staged_;             // short rows of a group that has a long row, or does not fit into the page
    Buffer<std::uint32_t> columns_;        // objects `b` of a bucket, row by row
    std::vector<std::uint32_t> row_ends_;  // by row of a bucket: position behind its last column; then second counters
    std::vector<std::uint64_t> bitmap_;    // columns of a long row
    RadixSort<std::uint32_t> radix_;       // sorts a long row
};

}  // namespace octopair
