// SIMD version of overlap(): tests all entries of a block at once. Highway compiles it for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/dynamic/small_block_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "octree/dynamic/small_block.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

std::uint32_t overlapping_simd(const SmallBlock& block, const SmallBox& wanted) {
    std::uint32_t hits = 0;
    for (std::size_t i = 0; i < block.count; ++i) hits |= std::uint32_t(overlap(block.box(i), wanted)) << i;
    return hits;
}

#else

std::uint32_t overlapping_simd(const SmallBlock& block, const SmallBox& wanted) {
    const hn::FixedTag<std::uint8_t, 16> d;  // the last 4 lanes read what follows the entries
    const auto at_most = [&](auto a, auto b) { return hn::Eq(hn::Min(a, b), a); };
    auto hits = hn::FirstN(d, block.count);
    for (unsigned axis = 0; axis < 3; ++axis) {
        // Low ends count from 0, but from 1 if the wanted box begins before the unit: at most one of two boxes may do so
        // (reports()).
        const std::uint8_t first = wanted.lo(axis) == 0 ? 1 : 0;
        const auto lo = hn::Sub(hn::LoadU(d, block.lo[axis].data()), hn::Set(d, first));
        const auto hi = hn::LoadU(d, block.hi[axis].data());
        hits = hn::And(hits, at_most(lo, hn::Set(d, std::uint8_t(wanted.hi(axis) - first))));
        hits = hn::And(hits, at_most(hn::Set(d, wanted.lo(axis)), hi));
    }
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hits, bits);
    return std::uint32_t(bits[0]) | std::uint32_t(bits[1]) << 8;
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(overlapping_simd);

std::uint32_t overlapping(const SmallBlock& block, const SmallBox& wanted) {
    return HWY_DYNAMIC_DISPATCH(overlapping_simd)(block, wanted);
}

}  // namespace octopair

#endif  // HWY_ONCE
