// SortKey: where a box begins on an axis and its position in a list, as one number in the order of a sweep.
#pragma once

#include <bit>
#include <cstdint>
#include <stop_token>

#include "base/memory.hpp"
#include "octree/executor.hpp"

namespace octopair {

using SortKey = std::uint64_t;

/// Ascending by `low`, then by position. (-0 comes before 0, which sweeps do not mind.)
inline SortKey sort_key(float low, std::uint32_t position) {
    const auto bits = std::bit_cast<std::uint32_t>(low);
    return SortKey(bits ^ (bits >> 31 != 0 ? ~0u : 0x80000000u)) << 32 | position;
}

inline std::uint32_t position_of(SortKey key) { return std::uint32_t(key); }

inline float low_of(SortKey key) {
    const auto bits = std::uint32_t(key >> 32);
    return std::bit_cast<float>(bits ^ (bits >> 31 != 0 ? 0x80000000u : ~0u));
}

/// Sorts keys that are ascending by position: an LSD radix sort whose passes are shared out. Throws Error{cancelled}.
/// Takes as much memory again while it runs.
void radix_sort(Buffer<SortKey>& keys, Executor& executor, const std::stop_token& stop);

}  // namespace octopair
