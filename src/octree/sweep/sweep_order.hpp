// SweepOrder: estimates the cost of a sweep along an axis, and sorts boxes for a sweep.
//
// Invariant
//   All results are functions of the boxes alone (integer sums, total orders). So the choice of the axis, and with it the
//   order of the pairs, is the same for any number of threads.
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

/// The entries at some positions of a span, or all entries of the span. Borrows both spans.
struct EntryList {
    std::span<const Entry> entries;
    std::span<const std::uint32_t> positions = {};
    bool all = true;

    std::size_t size() const { return all ? entries.size() : positions.size(); }
    std::uint32_t position(std::size_t i) const { return all ? std::uint32_t(i) : positions[i]; }
    const Entry& operator[](std::size_t i) const { return entries[position(i)]; }
};

/// Measures and sorts sets, and keeps its memory between calls.
/// Throws: Error{cancelled}; checks for a stop request between its loops over a set.
/// Thread safety: one thread at a time.
class SweepOrder {
public:
    explicit SweepOrder(std::stop_token stop) : stop_(std::move(stop)) {}

    /// Returns an estimate of the number of columns that a sweep along `axis` tests, summed over all rows.
    std::uint64_t tests(const EntryList& rows, const EntryList& columns, unsigned axis);

    /// Returns the keys of a list of any size in the order (min on the axis, position). The span is valid until the next call.
    std::span<const SortKey> sort(const EntryList& list, unsigned axis, Executor& executor);

private:
    struct Buckets {
        float begin = 0;
        float scale = 0;
        std::uint32_t last = 0;
        std::uint32_t of(float value) const {
            const float scaled = (value - begin) * scale;
            const float below = scaled > 0.0f ? scaled : 0.0f;  // 0 also where 0 * infinity gave NaN
            return below < float(last) ? std::uint32_t(below) : last;
        }
    };
    static Buckets buckets_for(const EntryList& list, unsigned axis);
    void make_keys(const EntryList& list, unsigned axis);
    void sort_in_cache(const EntryList& list, unsigned axis);

    std::stop_token stop_;
    std::vector<float> lows_;
    std::vector<std::uint32_t> counts_;
    std::vector<std::uint32_t> buckets_;  // bucket of each box
    Buffer<SortKey> keys_, scratch_;
};

/// Returns an estimate of the number of rows and columns that overlap, from a few rows at fixed positions.
/// Throws: Error{cancelled}.
std::uint64_t estimated_hits(const EntryList& rows, const EntryList& columns, const std::stop_token& stop);

}  // namespace octopair
