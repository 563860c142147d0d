// Entry: what an octant stores of an object's box.
//
// Invariants
//   `min` and `max` are the caller's box in float32, moved to a near origin, widened by margin and padding, and rounded outward
//   (box_source.hpp). So the entries of a pair always overlap.
//   An octant reports two of its entries only if (a.mask & b.mask) == 0. The bits of `mask`:
//     bits 0..2  class bits, one for each axis: the box begins before this octant, or before an octant around it. They decide
//                which octant reports a pair (octree/reporting_octant.hpp).
//     bit 3, 4   the object belongs to the first, the second set of a join. Pairs within a set do not count.
//     bit 5      the object is fixed in a scene. Pairs of two fixed objects do not count.
#pragma once

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdint>

namespace octopair {

struct alignas(32) Entry {
    float min[3];
    float max[3];
    std::uint32_t object;
    std::uint32_t mask;
};
static_assert(sizeof(Entry) == 32);

inline constexpr std::uint32_t first_set = 8;
inline constexpr std::uint32_t second_set = 16;
inline constexpr std::uint32_t fixed_object = 32;

/// True if the closed boxes overlap: the specification of the sweep kernels.
inline bool overlap(const Entry& a, const Entry& b) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis])) return false;
    }
    return true;
}

/// Depth of an overlap on each axis.
using Depths = std::array<float, 3>;

/// Bound on the growth of entries by rounding: on each axis `part` of the coordinates plus `base`.
struct RoundingSlack {
    static constexpr float part = 0x1p-20f;
    Depths base = {0, 0, 0};

    /// Returns a depth: boxes that overlap more deeply also overlapped before rounding. `largest`: largest absolute coordinate
    /// of the boxes. The depth is infinite at the end of float32's range, where the true end of a box is unknown.
    float depth(unsigned axis, float largest) const { return (largest + largest) * part + base[axis]; }
};

/// True if the boxes overlap by more than `depths` on each axis: the specification of keep_deep() (octree/sweep/sweep.hpp).
inline bool deep(const Entry& a, const Entry& b, const Depths& depths) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (!(std::min(a.max[axis] - b.min[axis], b.max[axis] - a.min[axis]) > depths[axis])) return false;
    }
    return true;
}

}  // namespace octopair
