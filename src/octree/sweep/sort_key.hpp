// SortKey: the low end of a box on an axis and the box's position in a list, packed into one integer. Keys sort in the order of
// a sweep: by low end, ties by position. Which object of a pair with equal low ends comes first is decided by SweepKind
// (sweep.hpp) and Orientation (pair_maker.hpp).
// Start here to change how boxes with equal starts are ordered.
#pragma once

#include <bit>
#include <cstdint>
#include <stop_token>

#include "base/memory.hpp"
#include "octree/executor.hpp"

namespace octopair {

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

/// Order of numbers in which NaN comes last. Boxes that change during a search may be NaN. With NaN, `<` is not a strict weak order,
/// which sorting requires.
struct NanLast {
    bool operator()(float a, float b) const { return a < b || (b != b && a == a); }
};

/// Sorts keys with an LSD radix sort by low end, in shares of `executor`.
/// Requires: the keys ascend by position.
/// Throws: Error{cancelled}.
/// Complexity: the memory of the keys once more while it runs.
void radix_sort(Buffer<SortKey>& keys, Executor& executor, const std::stop_token& stop);

}  // namespace octopair
