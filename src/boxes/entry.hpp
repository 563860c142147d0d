// Entry: what an octant stores of an object's box, and the rule which octant reports a pair.
// Start here to change which octant reports a pair.
//
// A pair meets in several octants if both boxes have entries there. Exactly one of these octants reports the pair.
//
// Rule        The octant that holds the low corner of the intersection of the two boxes reports the pair.
// Class bits  An entry has a class bit for each axis. The bit is set if the box begins before this octant (class_bits()), or before
//             an octant around it, up to the outermost octree. Bits are only added: an octant below keeps a bit that is set.
// Decision    An octant reports two of its entries only if no bit of their masks is set in both (reports()). For if both boxes begin
//             before the octant on an axis, their intersection also does. The sweeps' kernels make the same AND, a register at a time.
// Dynamic     An octree that changes follows the same rule, by low ends that are 0 before a unit (octree/dynamic/small_block.hpp).
// Nesting     The rule holds for any nesting of octrees. The proof is in docs/proofs.md ("Each pair once").
//
// Invariants
//   `min` and `max` of an Entry are the caller's box in float32, moved to a near origin, widened by margin and padding, and rounded
//   outward (box_source.hpp). So the entries of a pair always overlap.
//   A CellEntry has its bounds in cells of its octant. OctantCells (octree/plan/octant_cells.hpp) is the map to these cells.
//   The bits of `mask`, which a CellEntry has as flags:
//     bits 0..2  class bits, one for each axis
//     bit 3, 4   the object belongs to the first, the second set of a join. Pairs within a set do not count.
//     bit 5      the object is fixed in a scene. Pairs of two fixed objects do not count.
//
// Source: the classes are those of Tsitsigkos et al., arXiv 2307.09256.
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

/// An octant has 2^cell_bits cells on each axis.
inline constexpr unsigned cell_bits = 15;
inline constexpr std::uint32_t last_octant_cell = (1u << cell_bits) - 1;

/// An entry in 16 bytes.
struct alignas(16) CellEntry {
    /// By axis of the sweep: bits 0 to 14 the cell of the low end, bits 16 to 30 the cell of the high end, bits 15 and 31
    /// flags. Bit 15: class bit of this axis. Bit 31: first_set, second_set or fixed_object, one on each axis.
    std::array<std::uint32_t, 3> ends;
    std::uint32_t object;

    static constexpr unsigned class_shift = 15, set_shift = 31;
    static constexpr std::uint32_t class_bit = 1u << class_shift;
    static constexpr std::uint32_t flag_bits = class_bit | 1u << set_shift;
    static constexpr std::uint32_t end_bits = ~flag_bits;

    std::uint32_t low(unsigned k) const { return ends[k] & last_octant_cell; }
    std::uint32_t high(unsigned k) const { return ends[k] >> 16 & last_octant_cell; }
};
static_assert(sizeof(CellEntry) == 16);

/// Returns the axes, as class bits, on which a box begins before an octant. `lo` of both is their first cell on each axis.
template <typename Box, typename Octant>
std::uint32_t class_bits(const Box& box, const Octant& octant) {
    std::uint32_t axes = 0;
    for (unsigned axis = 0; axis < 3; ++axis) axes |= std::uint32_t(box.lo[axis] < octant.lo[axis]) << axis;
    return axes;
}

/// True if an octant reports a pair of overlapping boxes whose entries have these masks there.
inline bool reports(std::uint32_t mask_a, std::uint32_t mask_b) { return (mask_a & mask_b) == 0; }
inline bool reports(const CellEntry& a, const CellEntry& b) {
    return (((a.ends[0] & b.ends[0]) | (a.ends[1] & b.ends[1]) | (a.ends[2] & b.ends[2])) & CellEntry::flag_bits) == 0;
}

/// True if an entry has no class bit. In an octree that is not nested, the box then begins in the entry's octant.
inline bool has_no_class_bit(const CellEntry& entry) {
    return ((entry.ends[0] | entry.ends[1] | entry.ends[2]) & CellEntry::class_bit) == 0;
}

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

/// True if the boxes overlap by more than `depths` on each axis: the specification of judge_hits() (octree/sweep/box_sweep.hpp).
inline bool deep(const Entry& a, const Entry& b, const Depths& depths) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (!(std::min(a.max[axis] - b.min[axis], b.max[axis] - a.min[axis]) > depths[axis])) return false;
    }
    return true;
}

}  // namespace octopair
