// Entry: a box as the octree carries it, and the rule that reports each pair once.
//
// `min` and `max` are the caller's box in float32, moved to a near origin, widened by margin and padding and rounded
// outward, so boxes of a pair that counts always overlap here (box_source.hpp).
//
// `mask` decides which octant reports a pair: an octant reports two of its entries only if (a.mask & b.mask) == 0.
//   bits 0..2  class bits, one an axis: the box begins before this octant, or before one of the octants around it, up to
//              the outermost octree. A bit that is set stays set on the way down. An octant then reports a pair exactly if
//              it holds the low corner of the boxes' intersection, whatever octrees are nested in it (docs/design.md has
//              the argument). The classes are those of Tsitsigkos et al., arXiv 2307.09256.
//   bit 3, 4   the object belongs to the first, the second set of a join: pairs within a set do not count.
//   bit 5      the object is fixed in a scene: pairs of fixed objects do not count.
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

inline constexpr std::uint32_t begins_before = 7;  ///< the three class bits
inline constexpr std::uint32_t first_set = 8;
inline constexpr std::uint32_t second_set = 16;
inline constexpr std::uint32_t fixed_object = 32;  ///< of a scene

/// True if the closed boxes overlap: the specification of what the sweep kernels compute.
inline bool overlap(const Entry& a, const Entry& b) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis])) return false;
    }
    return true;
}

/// A length on each axis.
using Depths = std::array<float, 3>;

/// What rounding may have added to entries, on each axis: `part` of the coordinates, and `base` whatever they are.
struct RoundingSlack {
    static constexpr float part = 0x1p-20f;
    Depths base = {0, 0, 0};

    /// Boxes whose coordinates are at most `largest`, without their sign, and that overlap deeper than this, overlapped
    /// before rounding. Infinite at the end of float32's range: a bound there says nothing of where the box ends.
    float depth(unsigned axis, float largest) const { return (largest + largest) * part + base[axis]; }
};

/// True if the boxes overlap by more than `depths`: the specification of the kernel's keep_deep.
inline bool deep(const Entry& a, const Entry& b, const Depths& depths) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (!(std::min(a.max[axis] - b.min[axis], b.max[axis] - a.min[axis]) > depths[axis])) return false;
    }
    return true;
}

}  // namespace octopair
