// SweepOrder: sorts boxes for a sweep.
//
// Invariant
//   The order is total: by low end, then by position. So it is the same for any number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "boxes/entry.hpp"
#include "octree/executor.hpp"
#include "octree/sweep/entry_list.hpp"

namespace octopair {

/// Sorts sets, and keeps its memory between calls.
/// Throws: Error{cancelled}; checks for a stop request between its loops over a set.
/// Thread safety: one thread at a time.
class SweepOrder {
public:
    explicit SweepOrder(std::stop_token stop) : stop_(std::move(stop)) {}

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
    Buckets buckets_for_keys() const;
    void make_keys(const EntryList& list, unsigned axis);
    void sort_in_cache();

    std::stop_token stop_;
    std::vector<std::uint32_t> counts_;
    std::vector<std::uint32_t> buckets_;  // bucket of each box
    Buffer<SortKey> keys_, scratch_;
};

}  // namespace octopair
