// A box is six floats, read as two registers that overlap; compiled for each instruction set by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/box_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <cfloat>
#include <cstring>

#include "geometry/box_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

bool copy_boxes_simd(std::span<const Box3f> boxes, std::span<Entry> out) {
    bool good = true;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        std::memcpy(&out[i], &boxes[i], sizeof(Box3f));
        good &= is_box(boxes[i]);
    }
    return good;
}

#else

bool copy_boxes_simd(std::span<const Box3f> boxes, std::span<Entry> out) {
    const hn::FixedTag<float, 4> floats;
    const hn::FixedTag<std::uint32_t, 4> words;
    alignas(16) constexpr std::array<std::uint32_t, 4> fourth = {0, 0, 0, ~0u};
    const auto ignored = hn::BitCast(floats, hn::Load(words, fourth.data()));
    const auto largest = hn::Set(floats, FLT_MAX);
    auto good = hn::BitCast(floats, hn::Set(words, ~0u));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        std::memcpy(&out[i], &boxes[i], sizeof(Box3f));
        const float* const numbers = reinterpret_cast<const float*>(&boxes[i]);
        const auto first = hn::LoadU(floats, numbers);       // min x, y, z, max x
        const auto second = hn::LoadU(floats, numbers + 2);  // min z, max x, y, z
        const auto ordered = hn::VecFromMask(floats, hn::Le(first, hn::Shuffle0321(second)));
        const auto finite = hn::And(hn::Le(hn::Abs(first), largest), hn::Le(hn::Abs(second), largest));
        good = hn::And(good, hn::And(hn::Or(ordered, ignored), hn::VecFromMask(floats, finite)));
    }
    return hn::AllTrue(floats, hn::MaskFromVec(good));
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(copy_boxes_simd);

bool copy_boxes(std::span<const Box3f> boxes, std::span<Entry> out) {
    return HWY_DYNAMIC_DISPATCH(copy_boxes_simd)(boxes, out);
}

}  // namespace octopair

#endif  // HWY_ONCE
