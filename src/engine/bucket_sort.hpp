// BucketSort: sorts pairs into ascending order (by a, then b) with one bucket for each range of neighbouring `a`.
//
// 1. Each thread or worker scatters the pairs that it finds into its own buckets. A bucket is a PageString: an array of pairs that grows
//    by pages (engine/pair_pages.hpp), which have a fixed size and later form a list.
// 2. Each bucket is gathered from all threads or workers and sorted independently, by one of three ways:
//      few pairs for its rows   the pairs are sorted as they are
//      mostly short rows        the objects `b` of a row are put into slots, and sorted by networks (boxes/slotted_rows.hpp)
//      otherwise                pairs are counted by `a` and moved to their rows, then the objects `b` of each row are sorted
//                               (engine/counted_rows.hpp)
//
// Invariants
//   Every key in bucket i is less than every key in bucket i + 1.
//   The sorted result does not depend on which thread or worker found a pair.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "base/tuning.hpp"
#include "boxes/slotted_rows.hpp"
#include "engine/counted_rows.hpp"
#include "engine/pair_pages.hpp"
#include "octopair/objects.hpp"

namespace octopair {

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

/// Takes the strings of one bucket from the buckets of all threads or workers.
inline std::vector<PageString> take_bucket(std::span<std::vector<PageString>> of_fillers, std::size_t bucket) {
    std::vector<PageString> strings;
    strings.reserve(of_fillers.size());
    for (auto& buckets : of_fillers) strings.push_back(std::exchange(buckets[bucket], {}));
    return strings;
}

/// Sorts the pairs of one bucket at a time. Keeps its memory for the next bucket.
/// Thread safety: one thread at a time.
class BucketSort {
public:
    using Runs = PageWriter::Runs;
    BucketSort(const BucketPlan& plan, Pages& pages) : plan_(plan), pages_(pages) {}

    /// Returns the sorted pairs as runs in pages. Each input page returns to the pages' free list as soon as it is read. If
    /// `spent` is not null, the input pages are appended to it unchanged instead.
    /// Throws: Error{cancelled}, OverBudget.
    Runs sort(std::vector<PageString>&& strings, const std::stop_token& stop, std::vector<Pair*>* spent = nullptr);

private:
    struct CallState;
    void sort(std::vector<PageString>&& strings, unsigned bits, CallState& state);
    void split(std::vector<PageString>&& strings, unsigned bits, CallState& state);
    void sort_sparse(const std::vector<PageString>& strings, CallState& state);
    void sort_in_slots(const std::vector<PageString>& strings, unsigned bits, CallState& state);
    void write_group(std::size_t first_row, unsigned bits, PageWriter& writer);
    void sort_counted(const std::vector<PageString>& strings, unsigned bits, CallState& state);

    const BucketPlan& plan_;
    Pages& pages_;
    std::vector<Pair> sparse_;  // pairs of a bucket with many empty rows
    SlottedRows slotted_;       // pairs of a bucket with short rows
    std::vector<Pair> staged_;  // short rows of a group that has a long row, or does not fit into the page
    CountedRows counted_;       // other pairs, and long rows of slotted_
};

}  // namespace octopair
