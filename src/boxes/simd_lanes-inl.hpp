// SIMD helpers of kernels, for the instruction set that Highway compiles.
//
// Included by kernels after hwy/highway.h, once for each instruction set.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#ifndef OCTOPAIR_BOXES_LANE_TABLE
#define OCTOPAIR_BOXES_LANE_TABLE

namespace octopair {

/// Table of the lanes in each set of eight lanes. It moves the lanes of a set to the front of registers of at most eight lanes. It replaces Highway's own table, which g++ 12 copies on each use.
struct LaneTable {
    static constexpr std::size_t lanes = 8;
    // Arrays by set. A set is a bit mask of lanes.
    std::array<std::array<std::uint8_t, lanes>, 1 << lanes> of{};  ///< lanes of the set, ascending
    std::array<std::uint8_t, 1 << lanes> count{};                  ///< number of lanes of the set

    constexpr LaneTable() {
        for (std::size_t set = 0; set < of.size(); ++set) {
            for (std::uint8_t lane = 0; lane < lanes; ++lane) {
                if (set >> lane & 1u) of[set][count[set]++] = lane;
            }
        }
    }
};
inline constexpr LaneTable lanes_in;

}  // namespace octopair

#endif

#if defined(OCTOPAIR_BOXES_SIMD_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOPAIR_BOXES_SIMD_LANES_INL_HPP
#undef OCTOPAIR_BOXES_SIMD_LANES_INL_HPP
#else
#define OCTOPAIR_BOXES_SIMD_LANES_INL_HPP
#endif

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A bit mask of `count` lanes.
template <std::size_t count>
using BitMask = std::conditional_t<(count > 32), std::uint64_t, std::uint32_t>;

/// Returns a mask as bits: bit k is that of lane k.
template <typename D, typename M>
HWY_INLINE BitMask<hn::MaxLanes(D())> bits_of(D d, M mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    BitMask<hn::MaxLanes(D())> bits;
    std::memcpy(&bits, bytes, sizeof(bits));
    return bits;
}

#if HWY_TARGET != HWY_SCALAR

/// Maximum number of lanes of Words.
inline constexpr std::size_t max_lanes = HWY_TARGET <= HWY_AVX3 ? 16 : LaneTable::lanes;
using Words = hn::CappedTag<std::uint32_t, max_lanes>;
using Lanes = hn::Vec<Words>;

/// Number of each lane. Highway's Iota makes g++ 12 store the numbers one by one.
HWY_INLINE Lanes lane_numbers() {
    alignas(64) static constexpr std::uint32_t numbers[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return hn::Load(Words(), numbers);
}

/// Returns a bit mask of the first `count` lanes, or of all lanes if there are fewer.
HWY_INLINE std::uint32_t first_lanes(std::size_t count) {
    constexpr std::uint32_t all = (1u << hn::MaxLanes(Words())) - 1;
    return count >= hn::MaxLanes(Words()) ? all : (1u << count) - 1;
}

#if HWY_TARGET <= HWY_AVX3

/// Moves the lanes of a set to the front of registers.
class LanesToFront {
public:
    HWY_INLINE explicit LanesToFront(std::uint32_t set) {
        const std::uint8_t bytes[8] = {std::uint8_t(set), std::uint8_t(set >> 8)};
        mask_ = hn::LoadMaskBits(Words(), bytes);
    }
    HWY_INLINE Lanes operator()(Lanes numbers) const { return hn::Compress(numbers, mask_); }

private:
    hn::Mask<Words> mask_;
};

#else

class LanesToFront {
public:
    HWY_INLINE explicit LanesToFront(std::uint32_t set)
        : lanes_(hn::IndicesFromVec(Words(), hn::PromoteTo(Words(), hn::LoadU(Bytes(), lanes_in.of[set].data())))) {}
    HWY_INLINE Lanes operator()(Lanes numbers) const { return hn::TableLookupLanes(numbers, lanes_); }

private:
    using Bytes = hn::Rebind<std::uint8_t, Words>;
    decltype(hn::IndicesFromVec(Words(), Lanes())) lanes_;
};

#endif

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

/// Loads the four numbers of items i, i + 4 and so on, one item for each block of four lanes. at(i): address of item i.
template <typename D, typename At>
HWY_INLINE hn::Vec<D> load_blocks(D d, std::size_t i, const At& at) {
    constexpr std::size_t lanes = hn::MaxLanes(D());
    if constexpr (lanes == 4) {
        return hn::LoadU(d, at(i));
    } else {
        const hn::Half<D> half;
        return hn::Combine(d, load_blocks(half, i + lanes / 2, at), load_blocks(half, i, at));
    }
}

/// Stores blocks of four numbers to items i, i + 4 and so on. at(i): address of item i, aligned to 16 bytes.
template <typename D, typename At>
HWY_INLINE void store_blocks(D d, hn::Vec<D> blocks, std::size_t i, const At& at) {
    constexpr std::size_t lanes = hn::MaxLanes(D());
    if constexpr (lanes == 4) {
        hn::Store(blocks, d, at(i));
    } else {
        const hn::Half<D> half;
        store_blocks(half, hn::LowerHalf(half, blocks), i, at);
        store_blocks(half, hn::UpperHalf(half, blocks), i + lanes / 2, at);
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
