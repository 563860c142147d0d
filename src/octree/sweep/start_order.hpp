// The order in which a sweep meets boxes: by their low ends, which are their starts, on the axis of the sweep.
// Start here to change how boxes with equal starts are ordered.
//
// Boxes with equal low ends
//   in one list           are ordered by position (SortKey, StartOrder).
//   in one octant         are ordered by position, too. There, boxes of a bucket of low ends count as equal (CellSet in cell_sweep.hpp).
//   of rows and columns   count as if the row began first (SweepKind in sweep.hpp).
//   in a recursive sweep  are ordered by object (comes_before()).
//
// Invariant
//   Each of these orders is total, and a function of the boxes alone. So it is the same for any number of threads.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "base/memory.hpp"
#include "boxes/entry.hpp"
#include "octree/executor.hpp"

namespace octopair {

class EntryList;

/// The low end of a box on an axis, and below it the box's position in a list.
using SortKey = std::uint64_t;

/// Returns a key that sorts by `low`, then by position. Sorts -0 before 0, which does not change the hits of a sweep.
inline SortKey sort_key(float low, std::uint32_t position) {
    const auto bits = std::bit_cast<std::uint32_t>(low);
    return SortKey(bits ^ (bits >> 31 != 0 ? ~0u : 0x80000000u)) << 32 | position;
}

inline std::uint32_t position_of(SortKey key) { return std::uint32_t(key); }

inline float low_of(SortKey key) {
    const auto bits = std::uint32_t(key >> 32);
    return std::bit_cast<float>(bits ^ (bits >> 31 != 0 ? 0x80000000u : ~0u));
}

/// True if `a` comes before `b` in the order (low end on the axis, object).
inline bool comes_before(const Entry& a, const Entry& b, unsigned axis) {
    return a.min[axis] != b.min[axis] ? a.min[axis] < b.min[axis] : a.object < b.object;
}

/// Order of floats in which NaN comes last. With NaN, `<` is not the strict weak order that sorting requires. Bounds may become NaN if
/// the caller changes the boxes during a search.
struct NanLast {
    bool operator()(float a, float b) const { return a < b || (b != b && a == a); }
};

/// Sorts keys with an LSD radix sort by low end, in shares of `executor`.
/// Requires: the keys ascend by position.
/// Throws: Error{cancelled}.
/// Complexity: while it runs, it needs as much memory again as the keys.
void radix_sort(Buffer<SortKey>& keys, Executor& executor, const std::stop_token& stop);

/// Sorts boxes for a sweep, and keeps its memory between calls.
/// Throws: Error{cancelled}; checks for a stop request between its loops over a set.
/// Thread safety: one thread at a time.
class StartOrder {
public:
    explicit StartOrder(std::stop_token stop) : stop_(std::move(stop)) {}

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
