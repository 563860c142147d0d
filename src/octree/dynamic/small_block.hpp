// SmallBlock: a few boxes in 8 bits a number, relative to the unit of a MutableOctree that keeps them, and their objects.
//
// All numbers are rounded down by one monotone map, so boxes that overlap do so here. A lower end is 0 where the box
// begins before the unit, and more elsewhere: two boxes are reported in the unit that holds the low corner of their
// intersection.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace octopair {

/// A byte an axis, in one register.
struct SmallBox {
    std::uint32_t lo_bytes = 0, hi_bytes = 0;

    void set(unsigned axis, std::uint32_t lo, std::uint32_t hi) {
        lo_bytes |= lo << (8 * axis);
        hi_bytes |= hi << (8 * axis);
    }
    std::uint8_t lo(unsigned axis) const { return std::uint8_t(lo_bytes >> (8 * axis)); }
    std::uint8_t hi(unsigned axis) const { return std::uint8_t(hi_bytes >> (8 * axis)); }
};

/// Two lines of memory.
struct alignas(64) SmallBlock {
    static constexpr std::size_t capacity = 12;

    std::array<std::array<std::uint8_t, capacity>, 3> lo, hi;  ///< [axis][entry]
    std::uint32_t next;   ///< block of the same unit, or none; all but the first are full
    std::uint32_t count;  ///< entries, from the first on
    std::array<std::uint32_t, capacity> objects;

    static constexpr std::uint32_t none = ~std::uint32_t(0);

    SmallBox box(std::size_t i) const;
    void set(std::size_t i, const SmallBox& box, std::uint32_t object);
};
static_assert(sizeof(SmallBlock) == 128);

/// Whether the two are to be reported to each other: the specification of overlapping().
inline bool overlap(const SmallBox& a, const SmallBox& b) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (a.lo(axis) > b.hi(axis) || b.lo(axis) > a.hi(axis)) return false;
        if ((a.lo(axis) | b.lo(axis)) == 0) return false;
    }
    return true;
}

/// The entries of a block that overlap `wanted`, as bits.
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
