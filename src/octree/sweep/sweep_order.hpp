// Which way to sweep: what a sweep along an axis would cost, and the order of boxes for it.
//
// All of these are functions of the boxes alone (integer sums, total orders), so the choice, and with it the order of
// the pairs, is the same for any number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "boxes/entry.hpp"
#include "octree/executor.hpp"
#include "octree/sample.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair {

/// Entries by their positions, or all of them. Borrowed.
struct EntryList {
    std::span<const Entry> entries;
    std::span<const std::uint32_t> positions = {};
    bool all = true;

    std::size_t size() const { return all ? entries.size() : positions.size(); }
    std::uint32_t position(std::size_t i) const { return all ? std::uint32_t(i) : positions[i]; }
    const Entry& operator[](std::size_t i) const { return entries[position(i)]; }
};

/// Measures and sorts sets; keeps its memory from call to call. One thread at a time. Throws Error{cancelled} between
/// its passes over a set.
class SweepOrder {
public:
    explicit SweepOrder(std::stop_token stop) : stop_(std::move(stop)) {}

    /// About how many columns a sweep along `axis` tests for all rows.
    std::uint64_t tests(const EntryList& rows, const EntryList& columns, unsigned axis);

    /// Lays the list out in the order (min on the axis, position). For sets that stay in the cache.
    void lay_out(const EntryList& list, unsigned axis, SweepSet& set);

    /// The list in that order, whatever its size. The span is valid until the next call.
    std::span<const SortKey> sort(const EntryList& list, unsigned axis, Executor& executor);

private:
    struct Buckets {
        float begin = 0;
        float scale = 0;
        std::uint32_t last = 0;
        std::uint32_t of(float value) const {
            const float scaled = (value - begin) * scale;
            const float below = scaled > 0.0f ? scaled : 0.0f;  // also where 0 * infinity made a NaN
            return below < float(last) ? std::uint32_t(below) : last;
        }
    };
    static Buckets buckets_for(const EntryList& list, unsigned axis);
    void make_keys(const EntryList& list, unsigned axis);
    void sort_in_cache(const EntryList& list, unsigned axis);

    std::stop_token stop_;
    std::vector<float> lows_;
    std::vector<std::uint32_t> counts_;
    std::vector<std::uint32_t> buckets_;  // of each box
    Buffer<SortKey> keys_, scratch_;
};

/// About the columns that a sweep of laid out sets tests for all rows, from some rows at fixed places.
std::uint64_t sampled_tests(const Sweep& sweep);

/// About how many pairs of rows and columns overlap, from a few rows at fixed places.
/// Throws Error{cancelled}.
std::uint64_t estimated_hits(const EntryList& rows, const EntryList& columns, const std::stop_token& stop);

}  // namespace octopair
