// BucketSort: sorts pairs into ascending order (by a, then b) with one bucket for each range of neighbouring `a`.
//
// 1. Each thread or worker scatters the pairs that it finds into its own buckets. A bucket is a string of pages.
// 2. Each bucket is gathered from all threads or workers and sorted independently.
//
// Invariants
//   Every key in bucket i is less than every key in bucket i + 1.
//   The sorted result does not depend on which thread or worker found a pair.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "base/radix_sort.hpp"
#include "base/tuning.hpp"
#include "engine/ascending_bounds.hpp"
#include "engine/pair_pages.hpp"

namespace octopair {

/// Maps pairs to integer keys in ascending order of pairs. Keys have only the bits that the rows and columns need.
class PairKeys {
public:
    PairKeys(ObjectRange rows, std::uint64_t columns)
        : first_(rows.begin), count_(rows.end - rows.begin), b_bits_(unsigned(std::bit_width(columns))) {}

    /// Returns true if `pair.a` is in the range of rows.
    bool wanted(const Pair& pair) const { return pair.a - first_ < count_; }
    std::uint64_t key(const Pair& pair) const { return (pair.a - first_) << b_bits_ | pair.b; }
    Pair pair(std::uint64_t key) const {
        return {std::uint32_t((key >> b_bits_) + first_), std::uint32_t(key & ((std::uint64_t(1) << b_bits_) - 1))};
    }
    unsigned row_bits() const { return std::max(1u, unsigned(std::bit_width(count_))); }
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
        for (const Pair& pair : pairs) {
            if (keys_.wanted(pair)) strings[bucket(pair)].add(pair, pages);
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
    struct Task;
    void sort(std::vector<PageString>&& strings, unsigned bits, Task& task);
    void split(std::vector<PageString>&& strings, unsigned bits, Task& task);
    template <typename Key>
    void sort_at_once(const std::vector<PageString>& strings, unsigned bits, RadixSort<Key>& radix, Task& task);

    const BucketPlan& plan_;
    Pages& pages_;
    RadixSort<std::uint32_t> narrow_;
    RadixSort<std::uint64_t> wide_;
};

}  // namespace octopair
