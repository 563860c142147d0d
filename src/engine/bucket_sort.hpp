// Buckets of neighbouring `a`: how pairs come into ascending order.
//
// Whoever finds pairs throws them into buckets, strings of pages; then each bucket, gathered from all who filled it, is
// sorted on its own, so that order does not show who found what.
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

/// Pairs as numbers in the same order, of as few bits as the rows and columns need.
class PairKeys {
public:
    PairKeys(ObjectRange rows, std::uint64_t columns)
        : first_(rows.begin), count_(rows.end - rows.begin), b_bits_(unsigned(std::bit_width(columns))) {}

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

/// Which bucket a pair belongs to. A function of its arguments alone.
class BucketPlan {
public:
    /// `fillers`: how many fill buckets, each their own.
    BucketPlan(const AscendingBounds& bounds, unsigned fillers);

    static constexpr unsigned most_bits = default_tuning.output.bucket_bits;
    const PairKeys& keys() const { return keys_; }
    std::size_t buckets() const { return std::size_t(1) << bits_; }
    std::size_t bucket(const Pair& pair) const { return std::size_t(keys_.key(pair) >> key_bits()); }
    /// Of the key, within a bucket.
    unsigned key_bits() const { return keys_.bits() - bits_; }

    /// Throws the wanted ones of `pairs` into `strings`, one for each bucket.
    void fill(std::span<const Pair> pairs, std::span<PageString> strings, Pages& pages) const {
        for (const Pair& pair : pairs) {
            if (keys_.wanted(pair)) strings[bucket(pair)].add(pair, pages);
        }
    }

private:
    PairKeys keys_;
    unsigned bits_;
};

/// Puts the pairs of a bucket in order. One thread at a time; keeps its memory from bucket to bucket.
class BucketSort {
public:
    using Runs = std::vector<std::span<const Pair>>;
    BucketSort(const BucketPlan& plan, Pages& pages) : plan_(plan), pages_(pages) {}

    /// Returns the sorted pairs, in pages. The strings' own pages are given back as soon as they have been read or, if
    /// `spent` is given, are put there unchanged. Throws Error{cancelled}.
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
