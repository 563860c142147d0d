// SIMD versions of the functions of box_kernel.hpp. Highway compiles them for each instruction set. The six numbers of a box
// are read into two registers that overlap.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "boxes/box_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <cfloat>
#include <cstring>

#include "boxes/box_kernel.hpp"

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

bool are_boxes_simd(std::span<const Box3f> boxes) {
    bool good = true;
    for (const Box3f& box : boxes) good &= is_box(box);
    return good;
}

#else

/// Returns true if all boxes are valid. `out`: one entry for each box if `copied`, otherwise empty.
template <bool copied>
bool check_boxes_of(std::span<const Box3f> boxes, std::span<Entry> out) {
    const hn::FixedTag<float, 4> floats;
    const hn::FixedTag<std::uint32_t, 4> words;
    alignas(16) constexpr std::array<std::uint32_t, 4> fourth = {0, 0, 0, ~0u};
    const auto ignored = hn::BitCast(floats, hn::Load(words, fourth.data()));
    const auto largest = hn::Set(floats, FLT_MAX);
    auto good = hn::BitCast(floats, hn::Set(words, ~0u));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if constexpr (copied) std::memcpy(&out[i], &boxes[i], sizeof(Box3f));
        const float* const numbers = reinterpret_cast<const float*>(&boxes[i]);
        const auto first = hn::LoadU(floats, numbers);       // min x, y, z, max x
        const auto second = hn::LoadU(floats, numbers + 2);  // min z, max x, y, z
        const auto ordered = hn::VecFromMask(floats, hn::Le(first, hn::Shuffle0321(second)));
        const auto finite = hn::And(hn::Le(hn::Abs(first), largest), hn::Le(hn::Abs(second), largest));
        good = hn::And(good, hn::And(hn::Or(ordered, ignored), hn::VecFromMask(floats, finite)));
    }
    return hn::AllTrue(floats, hn::MaskFromVec(good));
}

bool copy_boxes_simd(std::span<const Box3f> boxes, std::span<Entry> out) { return check_boxes_of<true>(boxes, out); }
bool are_boxes_simd(std::span<const Box3f> boxes) { return check_boxes_of<false>(boxes, {}); }

#endif

constexpr std::size_t prefetched_pairs = 12;  // distance at which boxes are prefetched

/// Implements refused_pairs() without a branch on the result of overlaps(a, b).
template <typename Real, typename Overlaps>
std::size_t refused_of(const DoubtfulPairs& doubtful, const BoxesOfPairs<Real>& boxes, const Overlaps& overlaps,
                       std::uint32_t* out) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < doubtful.size(); ++k) {
        if (k + prefetched_pairs < doubtful.size()) {
            // Not in a lambda: GCC drops calls of a function that only prefetches, if it is not inlined early.
            const Pair& next = doubtful[k + prefetched_pairs];
            hwy::Prefetch(&boxes.a(next));
            hwy::Prefetch(&boxes.a(next).max[2]);  // a box may lie on two cache lines
            hwy::Prefetch(&boxes.b(next));
            hwy::Prefetch(&boxes.b(next).max[2]);
        }
        out[count] = doubtful.positions[k];
        count += overlaps(boxes.a(doubtful[k]), boxes.b(doubtful[k])) ? 0 : 1;
    }
    return count;
}

#if HWY_TARGET == HWY_SCALAR

std::size_t refused_narrow_simd(const DoubtfulPairs& doubtful, const BoxesOfPairs<float>& boxes, std::uint32_t* out) {
    return refused_of(doubtful, boxes, overlap<float>, out);
}

#else

std::size_t refused_narrow_simd(const DoubtfulPairs& doubtful, const BoxesOfPairs<float>& boxes, std::uint32_t* out) {
    const hn::FixedTag<float, 4> d;
    const auto low = [&](const Box3f& box) HWY_ATTR { return hn::LoadU(d, box.min); };
    const auto high = [&](const Box3f& box) HWY_ATTR { return hn::Shuffle0321(hn::LoadU(d, box.min + 2)); };
    const auto overlaps = [&](const Box3f& a, const Box3f& b) HWY_ATTR {
        const auto apart = hn::Or(hn::Gt(low(a), high(b)), hn::Gt(low(b), high(a)));
        return hn::AllFalse(d, hn::And(apart, hn::FirstN(d, 3)));
    };
    return refused_of(doubtful, boxes, overlaps, out);
}

#endif

std::size_t refused_wide_simd(const DoubtfulPairs& doubtful, const BoxesOfPairs<double>& boxes, std::uint32_t* out) {
    return refused_of(doubtful, boxes, overlap<double>, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(copy_boxes_simd);
HWY_EXPORT(are_boxes_simd);

bool are_boxes(std::span<const Box3f> boxes) { return HWY_DYNAMIC_DISPATCH(are_boxes_simd)(boxes); }

bool are_boxes(std::span<const Box3d> boxes) {
    bool good = true;
    for (const Box3d& box : boxes) good &= is_box(box);
    return good;
}

bool copy_boxes(std::span<const Box3f> boxes, std::span<Entry> out) {
    return HWY_DYNAMIC_DISPATCH(copy_boxes_simd)(boxes, out);
}

HWY_EXPORT(refused_narrow_simd);
HWY_EXPORT(refused_wide_simd);

std::size_t refused_pairs(const DoubtfulPairs& doubtful, const BoxesOfPairs<float>& boxes, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(refused_narrow_simd)(doubtful, boxes, out);
}

std::size_t refused_pairs(const DoubtfulPairs& doubtful, const BoxesOfPairs<double>& boxes, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(refused_wide_simd)(doubtful, boxes, out);
}

}  // namespace octopair

#endif  // HWY_ONCE
