// SmallBlock: entries of one unit of a MutableOctree: objects, and their boxes in 8 bits a number, relative to the unit.
//
// Invariants
//   All numbers are rounded down by one monotone map, so boxes that overlap in the space overlap here.
//   A low end is 0 if the box begins before the unit, otherwise greater. So class bits need no memory (SmallBox::class_bits()), and
//   two boxes are reported only in the unit that holds the low corner of their intersection (boxes/entry.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "boxes/entry.hpp"

namespace octopair {

/// A box with one byte for each end on each axis. The three bytes of an end are packed into one register.
struct SmallBox {
    std::uint32_t lo_bytes = 0, hi_bytes = 0;

    void set(unsigned axis, std::uint32_t lo, std::uint32_t hi) {
        lo_bytes |= lo << (8 * axis);
        hi_bytes |= hi << (8 * axis);
    }
    /// Lets a box that begins before the unit begin in it. Then it overlaps all entries that it meets in the unit, whatever their classes.
    void begin_inside() {
        for (unsigned axis = 0; axis < 3; ++axis) lo_bytes |= std::uint32_t(lo(axis) == 0) << (8 * axis);
    }
    std::uint8_t lo(unsigned axis) const { return std::uint8_t(lo_bytes >> (8 * axis)); }
    std::uint8_t hi(unsigned axis) const { return std::uint8_t(hi_bytes >> (8 * axis)); }
    /// Returns the axes, as class bits, on which the box begins before the unit.
    std::uint32_t class_bits() const {
        return std::uint32_t(lo(0) == 0) | std::uint32_t(lo(1) == 0) << 1 | std::uint32_t(lo(2) == 0) << 2;
    }
};

/// Two cache lines of entries.
struct alignas(64) SmallBlock {
    static constexpr std::size_t capacity = 12;

    std::array<std::array<std::uint8_t, capacity>, 3> lo, hi;  ///< [axis][entry]
    std::uint32_t next;   ///< next block of the unit, or `none`; all blocks of a unit but the first are full
    std::uint32_t count;  ///< number of entries; the others of the block are free
    std::array<std::uint32_t, capacity> objects;

    static constexpr std::uint32_t none = ~std::uint32_t(0);

    SmallBox box(std::size_t i) const;
    void set(std::size_t i, const SmallBox& box, std::uint32_t object);
};
static_assert(sizeof(SmallBlock) == 128);

/// True if the unit of the two boxes must report them as a hit. This is the specification of overlapping().
inline bool overlap(const SmallBox& a, const SmallBox& b) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (a.lo(axis) > b.hi(axis) || b.lo(axis) > a.hi(axis)) return false;
    }
    return reports(a.class_bits(), b.class_bits());
}

/// Returns a bit mask of the entries of `block` that overlap `wanted`.
std::uint32_t overlapping(const SmallBlock& block, const SmallBox& wanted);

inline SmallBox SmallBlock::box(std::size_t i) const {
    SmallBox box;
    for (unsigned axis = 0; axis < 3; ++axis) box.set(axis, lo[axis][i], hi[axis][i]);
    return box;
}

inline void SmallBlock::set(std::size_t i, const SmallBox& box, std::uint32_t object) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        lo[axis][i] = box.lo(axis);
        hi[axis][i] = box.hi(axis);
    }
    objects[i] = object;
}

}  // namespace octopair
