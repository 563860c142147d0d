// SIMD versions of the functions of box_kernel.hpp. Highway compiles them for each instruction set. The six numbers of a box
// are read into two registers that overlap.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "boxes/box_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <limits>

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

/// Specification of round_boxes(), for one box.
template <typename Real>
bool round_one(const Box<Real>& box, double padding, const OutwardRounding& rounding, Entry& out) {
    out = rounding.entry(wide(box), padding);
    return is_box(box) && is_padding(padding);
}

/// Specification of bound_triangles(), for one triangle.
bool bound_one(const Triangle3d& triangle, Box3f& box) {
    bool finite = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double a = triangle[0][axis], b = triangle[1][axis], c = triangle[2][axis];
        for (const double at : {a, b, c}) finite &= std::abs(at) <= DBL_MAX;
        box.min[axis] = 0.0f - rounding::finite_float_above(-std::min(std::min(a, b), c));
        box.max[axis] = rounding::finite_float_above(std::max(std::max(a, b), c));
    }
    return finite;
}

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL

using Doubles = hn::FixedTag<double, 4>;  // one end of a box, and a fourth number whose results are discarded

HWY_INLINE hn::Vec<Doubles> load_wide(const float* numbers) {
    return hn::PromoteTo(Doubles(), hn::LoadU(hn::FixedTag<float, 4>(), numbers));
}
HWY_INLINE hn::Vec<Doubles> load_wide(const double* numbers) { return hn::LoadU(Doubles(), numbers); }

/// SIMD version of finite_float_above() (geometry/rounding.hpp).
HWY_INLINE hn::Vec<hn::FixedTag<float, 4>> round_up_simd(hn::Vec<Doubles> value) {
    const Doubles d;
    const hn::FixedTag<float, 4> f;
    const hn::FixedTag<std::int32_t, 4> i;
    const auto most = hn::Set(d, double(FLT_MAX));
    const auto clamped = hn::Min(hn::Max(value, hn::Neg(most)), most);
    const auto nearest = hn::DemoteTo(f, clamped);
    const auto below = hn::DemoteTo(f, hn::IfThenElseZero(hn::Lt(hn::PromoteTo(d, nearest), clamped), hn::Set(d, 1.0)));
    const auto step =
        hn::BitCast(i, hn::VecFromMask(f, hn::Gt(below, hn::Zero(f))));  // -1 where the next float is needed
    // The next float up has one more in its bits if the number is >= 0, one less if it is negative; -0 counts as 0.
    const auto bits = hn::BitCast(i, hn::Add(nearest, hn::Zero(f)));
    const auto negative = hn::BroadcastSignBit(bits);
    const auto up = hn::Sub(hn::Xor(step, negative), negative);
    return hn::BitCast(f, hn::Sub(bits, up));
}

/// `widened`: true if there is a margin or padding.
template <bool widened, typename Real>
bool round_boxes_of(std::span<const Box<Real>> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                    std::span<Entry> out) {
    if (boxes.empty()) return true;
    const Doubles d;
    const hn::FixedTag<float, 4> f;
    const auto origin = hn::LoadU(d, rounding.origin.data());
    const auto largest = hn::Set(d, double(std::numeric_limits<Real>::max()));
    const auto part = hn::Set(d, OutwardRounding::error_part);
    const auto too_wide = hn::Set(d, OutwardRounding::max_widening);
    const auto everything = hn::Set(d, double(FLT_MAX));
    auto good = hn::MaskFromVec(hn::BitCast(d, hn::Set(hn::FixedTag<std::int64_t, 4>(), -1)));
    bool paddings_good = true;
    const std::size_t last = boxes.size() - 1;  // not in the loop, which reads one number beyond each box
    for (std::size_t k = 0; k < last; ++k) {
        const double own = padding.empty() ? 0 : padding[k];
        paddings_good &= is_padding(own);
        const auto widening = hn::Set(d, rounding.margin / 2 + own);
        const auto low = load_wide(boxes[k].min);
        const auto high = load_wide(boxes[k].max);
        const auto finite = hn::And(hn::Le(hn::Abs(low), largest), hn::Le(hn::Abs(high), largest));
        good = hn::And(good, hn::Or(hn::And(finite, hn::Le(low, high)), hn::Not(hn::FirstN(d, 3))));
        const auto outward = [&](auto bound, auto moved) HWY_ATTR {
            if constexpr (!widened) return round_up_simd(moved);
            const auto error = hn::Add(hn::Add(hn::Mul(hn::Abs(bound), part), hn::Mul(hn::Abs(origin), part)),
                                       hn::Mul(widening, part));
            const auto extra = hn::IfThenElseZero(hn::Gt(widening, hn::Zero(d)), hn::Add(widening, error));
            return round_up_simd(hn::IfThenElse(hn::Gt(widening, too_wide), everything, hn::Add(moved, extra)));
        };
        // Each store writes one number too many: the first store into `max`, which the second store overwrites; the second
        // store into `object`, which the caller sets.
        hn::StoreU(hn::Neg(outward(low, hn::Neg(hn::Sub(low, origin)))), f, out[k].min);
        hn::StoreU(outward(high, hn::Sub(high, origin)), f, out[k].max);
    }
    const double own = padding.empty() ? 0 : padding[last];
    return hn::AllTrue(d, good) && round_one(boxes[last], own, rounding, out[last]) && paddings_good;
}

template <typename Real>
bool round_boxes_simd(std::span<const Box<Real>> boxes, std::span<const double> padding,
                      const OutwardRounding& rounding, std::span<Entry> out) {
    return rounding.margin > 0 || !padding.empty() ? round_boxes_of<true>(boxes, padding, rounding, out)
                                                   : round_boxes_of<false>(boxes, padding, rounding, out);
}

bool bound_triangles_simd(std::span<const Triangle3d> triangles, std::span<Box3f> boxes) {
    if (triangles.empty()) return true;
    const Doubles d;
    const hn::FixedTag<float, 4> f;
    const auto zero = hn::Zero(d);
    auto zeros = zero;                              // becomes NaN at a number that is not finite: 0 * infinity is NaN
    const std::size_t last = triangles.size() - 1;  // not in the loop, which reads and writes one number too many
    for (std::size_t i = 0; i < last; ++i) {
        const auto a = hn::LoadU(d, triangles[i][0].data());
        const auto b = hn::LoadU(d, triangles[i][1].data());
        const auto c = hn::LoadU(d, triangles[i][2].data());
        zeros = hn::Add(zeros, hn::Add(hn::Mul(a, zero), hn::Add(hn::Mul(b, zero), hn::Mul(c, zero))));
        const auto low = hn::Min(hn::Min(a, b), c), high = hn::Max(hn::Max(a, b), c);
        hn::StoreU(hn::Sub(hn::Zero(f), round_up_simd(hn::Neg(low))), f, boxes[i].min);
        hn::StoreU(round_up_simd(high), f, boxes[i].max);
    }
    return bound_one(triangles[last], boxes[last]) && hn::AllTrue(d, hn::Eq(zeros, zero));
}

#else

bool bound_triangles_simd(std::span<const Triangle3d> triangles, std::span<Box3f> boxes) {
    bool finite = true;
    for (std::size_t i = 0; i < triangles.size(); ++i) finite &= bound_one(triangles[i], boxes[i]);
    return finite;
}

template <typename Real>
bool round_boxes_simd(std::span<const Box<Real>> boxes, std::span<const double> padding,
                      const OutwardRounding& rounding, std::span<Entry> out) {
    bool good = true;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        good &= round_one(boxes[i], padding.empty() ? 0 : padding[i], rounding, out[i]);
    }
    return good;
}

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

bool round_narrow_simd(std::span<const Box3f> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                       std::span<Entry> out) {
    return round_boxes_simd(boxes, padding, rounding, out);
}
bool round_wide_simd(std::span<const Box3d> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                     std::span<Entry> out) {
    return round_boxes_simd(boxes, padding, rounding, out);
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

HWY_EXPORT(round_narrow_simd);
HWY_EXPORT(round_wide_simd);

bool round_boxes(std::span<const Box3f> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Entry> out) {
    return HWY_DYNAMIC_DISPATCH(round_narrow_simd)(boxes, padding, rounding, out);
}

bool round_boxes(std::span<const Box3d> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Entry> out) {
    return HWY_DYNAMIC_DISPATCH(round_wide_simd)(boxes, padding, rounding, out);
}

HWY_EXPORT(refused_narrow_simd);
HWY_EXPORT(refused_wide_simd);

std::size_t refused_pairs(const DoubtfulPairs& doubtful, const BoxesOfPairs<float>& boxes, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(refused_narrow_simd)(doubtful, boxes, out);
}

std::size_t refused_pairs(const DoubtfulPairs& doubtful, const BoxesOfPairs<double>& boxes, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(refused_wide_simd)(doubtful, boxes, out);
}

HWY_EXPORT(bound_triangles_simd);

bool bound_triangles(std::span<const Triangle3d> triangles, std::span<Box3f> boxes) {
    return HWY_DYNAMIC_DISPATCH(bound_triangles_simd)(triangles, boxes);
}

}  // namespace octopair

#endif  // HWY_ONCE
