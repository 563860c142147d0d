// SIMD helpers of the octree's kernels, for the instruction set that Highway compiles.
//
// Included by kernels after hwy/highway.h, once for each instruction set.
#include <array>
#include <cstddef>
#include <cstdint>

#ifndef OCTOPAIR_OCTREE_LANE_TABLE
#define OCTOPAIR_OCTREE_LANE_TABLE

namespace octopair {

/// Table of the lanes in each set of lanes of a SIMD register. A kernel uses it to move the lanes of a set to the front of a register. It
/// replaces Highway's own table, which g++ 12 copies on each use.
struct LaneTable {
    static constexpr std::size_t lanes = 8;
    // Arrays by set. A set is a bit mask of lanes.
    std::array<std::array<std::uint8_t, lanes>, 1 << lanes> of{};    ///< lanes of the set, ascending
    std::array<std::array<std::uint8_t, lanes>, 1 << lanes> rank{};  ///< by lane: number of the set's lanes before
    std::array<std::uint8_t, 1 << lanes> count{};                    ///< number of lanes of the set

    constexpr LaneTable() {
        for (std::size_t set = 0; set < of.size(); ++set) {
            for (std::uint8_t lane = 0; lane < lanes; ++lane) {
                rank[set][lane] = count[set];
                if (set >> lane & 1u) of[set][count[set]++] = lane;
            }
        }
    }
};
inline constexpr LaneTable lanes_in;

}  // namespace octopair

#endif

#if defined(OCTOPAIR_OCTREE_SIMD_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOPAIR_OCTREE_SIMD_LANES_INL_HPP
#undef OCTOPAIR_OCTREE_SIMD_LANES_INL_HPP
#else
#define OCTOPAIR_OCTREE_SIMD_LANES_INL_HPP
#endif

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Returns a mask of up to 16 lanes as bits.
template <typename D, typename M>
HWY_INLINE std::uint32_t bits_of(D d, M mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    return std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8;
}

#if HWY_TARGET != HWY_SCALAR

using Words = hn::CappedTag<std::uint32_t, LaneTable::lanes>;
using Lanes = hn::Vec<Words>;

/// Returns small numbers, one for each lane.
HWY_INLINE Lanes lane_numbers(const std::array<std::uint8_t, LaneTable::lanes>& numbers) {
    return hn::PromoteTo(Words(), hn::LoadU(hn::Rebind<std::uint8_t, Words>(), numbers.data()));
}

/// Returns the index with which TableLookupLanes moves the lanes of a set to the front.
HWY_INLINE auto to_front(std::uint32_t set) { return hn::IndicesFromVec(Words(), lane_numbers(lanes_in.of[set])); }

/// Transposes blocks of four numbers. Before: block k of register i has the numbers of item 4 k + i. After: register i has number i of
/// all items. A second call restores the first form.
HWY_INLINE void transpose(Lanes (&registers)[4]) {
    const Words d;
    const auto lower02 = hn::InterleaveLower(d, registers[0], registers[2]);
    const auto lower13 = hn::InterleaveLower(d, registers[1], registers[3]);
    const auto upper02 = hn::InterleaveUpper(d, registers[0], registers[2]);
    const auto upper13 = hn::InterleaveUpper(d, registers[1], registers[3]);
    registers[0] = hn::InterleaveLower(d, lower02, lower13);
    registers[1] = hn::InterleaveUpper(d, lower02, lower13);
    registers[2] = hn::InterleaveLower(d, upper02, upper13);
    registers[3] = hn::InterleaveUpper(d, upper02, upper13);
}

/// Loads the four numbers of item i. If a register has eight lanes, also loads the four numbers of item i + 4. at(i): address of item i.
template <typename D, typename At>
HWY_INLINE hn::Vec<D> load_blocks(D d, std::size_t i, const At& at) {
    const hn::FixedTag<std::uint32_t, 4> block;
    const auto first = hn::LoadU(block, at(i));
    if constexpr (hn::MaxLanes(D()) == 8) {
        return hn::Combine(d, hn::LoadU(block, at(i + 4)), first);
    } else {
        return first;
    }
}

/// Loads four numbers of each item of a register's lanes: register i gets number i of all items.
template <typename At>
HWY_INLINE void load_items(Lanes (&registers)[4], const At& at) {
    const Words d;
    for (std::size_t i = 0; i < 4; ++i) registers[i] = load_blocks(d, i, at);
    transpose(registers);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#endif
