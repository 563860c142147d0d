// SIMD versions of the functions of outward_rounding.hpp. Highway compiles them for each instruction set. The six numbers of a box
// are read into two registers that overlap, or into one of AVX-512.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "boxes/outward_rounding.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

#include "boxes/box_check.hpp"
#include "boxes/box_kernel.hpp"
#include "boxes/outward_rounding.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Specification of round_boxes(), for one box. `Out`: Box3f or Entry.
template <typename Real, typename Out>
bool round_one(const Box<Real>& box, double padding, const OutwardRounding& rounding, Out& out) {
    const Entry entry = rounding.entry(wide(box), padding);
    std::copy_n(entry.min, 3, out.min);
    std::copy_n(entry.max, 3, out.max);
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

#if HWY_TARGET <= HWY_AVX2

using Doubles = hn::FixedTag<double, 4>;  // three coordinates, and a fourth number whose results are discarded

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
    return hn::Add(hn::BitCast(f, hn::Sub(bits, up)), hn::Zero(f));  // -0 becomes 0
}

/// Numbers of a box in a register: both ends and two more numbers, or one end and one more.
using Ends = hn::CappedTag<double, 8>;

#if HWY_TARGET <= HWY_AVX3

HWY_INLINE hn::Vec<hn::Rebind<float, Ends>> round_up_simd(hn::Vec<Ends> value) {
    const hn::Rebind<float, Ends> f;
    const auto most = hn::Set(Ends(), double(FLT_MAX));
    const auto clamped = hn::Min(hn::Max(value, hn::Neg(most)), most);
    const hn::Vec<decltype(f)> up{_mm512_cvt_roundpd_ps(clamped.raw, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC)};
    return hn::Add(up, hn::Zero(f));  // -0 becomes 0
}

#endif

HWY_INLINE hn::Vec<Ends> load_ends(const float* numbers) {
    return hn::PromoteTo(Ends(), hn::LoadU(hn::Rebind<float, Ends>(), numbers));
}
HWY_INLINE hn::Vec<Ends> load_ends(const double* numbers) { return hn::LoadU(Ends(), numbers); }

/// SIMD version of OutwardRounding::entry(), for numbers of a box. `widened`: true if there is a margin or padding.
template <bool widened>
class Outward {
public:
    using Floats = hn::Rebind<float, Ends>;
    /// `lows`: number of lanes, from the first on, that have a low end.
    Outward(const OutwardRounding& rounding, std::size_t lows) {
        alignas(64) double origins[8], signs[8];
        for (std::size_t i = 0; i < 8; ++i) {
            origins[i] = rounding.origin[i % 3];
            signs[i] = i < lows ? -0.0 : 0.0;
        }
        origin_ = hn::Load(Ends(), origins);
        sign_ = hn::Load(Ends(), signs);
    }
    HWY_INLINE hn::Vec<Floats> operator()(hn::Vec<Ends> bound, hn::Vec<Ends> widening) const {
        const Ends d;
        auto moved = hn::Xor(hn::Sub(bound, origin_), sign_);
        if constexpr (widened) {
            const auto part = hn::Set(d, OutwardRounding::error_part);
            const auto error = hn::Add(hn::Add(hn::Mul(hn::Abs(bound), part), hn::Mul(hn::Abs(origin_), part)),
                                       hn::Mul(widening, part));
            const auto extra = hn::IfThenElseZero(hn::Gt(widening, hn::Zero(d)), hn::Add(widening, error));
            const auto too_wide = hn::Gt(widening, hn::Set(d, OutwardRounding::max_widening));
            moved = hn::IfThenElse(too_wide, hn::Set(d, double(FLT_MAX)), hn::Add(moved, extra));
        }
        return hn::Xor(round_up_simd(moved), hn::DemoteTo(Floats(), sign_));
    }

private:
    hn::Vec<Ends> origin_, sign_;
};

/// Rounds boxes. all_good() says whether all were valid. Reads and writes up to two numbers beyond each box.
template <bool widened, typename Real>
class BoxRounder {
public:
    HWY_INLINE explicit BoxRounder(const OutwardRounding& rounding)
        : low_(rounding, 3), high_(rounding, 0), good_(hn::FirstN(Ends(), hn::MaxLanes(Ends()))) {}

    HWY_INLINE void round(const Box<Real>& box, double widening, float* min, float* max) {
        constexpr std::size_t read_ahead = 3072;  // bytes
        hwy::Prefetch(reinterpret_cast<const char*>(&box) + read_ahead);
        const Ends d;
        const typename Outward<widened>::Floats f;
        const auto wide = hn::Set(d, widening);
        const auto low = load_ends(box.min);
        hn::StoreU(low_(low, wide), f, min);
        if constexpr (hn::MaxLanes(Ends()) == 8) {
            (void)max;
            alignas(64) static constexpr std::int64_t upper[8] = {3, 4, 5, 3, 4, 5, 6, 7};
            check(low, hn::TableLookupLanes(low, hn::SetTableIndices(d, upper)), 6);
        } else {
            const auto high = load_ends(box.max);
            hn::StoreU(high_(high, wide), f, max);
            check(low, high, 3);
        }
    }
    HWY_INLINE bool all_good() const { return hn::AllTrue(Ends(), good_); }

private:
    /// Checks the first `count` lanes.
    HWY_INLINE void check(hn::Vec<Ends> low, hn::Vec<Ends> high, std::size_t count) {
        const Ends d;
        const auto largest = hn::Set(d, double(std::numeric_limits<Real>::max()));
        const auto finite = hn::And(hn::Le(hn::Abs(low), largest), hn::Le(hn::Abs(high), largest));
        good_ = hn::And(good_, hn::Or(hn::And(finite, hn::Le(low, high)), hn::Not(hn::FirstN(d, count))));
    }
    Outward<widened> low_, high_;
    hn::Mask<Ends> good_;
};

template <bool widened, typename Real, typename Out>
bool round_boxes_of(std::span<const Box<Real>> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                    std::span<Out> out) {
    if (boxes.empty()) return true;
    BoxRounder<widened, Real> rounder(rounding);
    bool paddings_good = true;
    const std::size_t last = boxes.size() - 1;  // not in the loop, which reads and writes beyond each box
    for (std::size_t k = 0; k < last; ++k) {
        const double own = padding.empty() ? 0 : padding[k];
        paddings_good &= is_padding(own);
        rounder.round(boxes[k], rounding.margin / 2 + own, out[k].min, out[k].max);
    }
    const double own = padding.empty() ? 0 : padding[last];
    return rounder.all_good() && round_one(boxes[last], own, rounding, out[last]) && paddings_good;
}

template <typename Real, typename Out>
bool round_boxes_simd(std::span<const Box<Real>> boxes, std::span<const double> padding,
                      const OutwardRounding& rounding, std::span<Out> out) {
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

template <typename Real, typename Out>
bool round_boxes_simd(std::span<const Box<Real>> boxes, std::span<const double> padding,
                      const OutwardRounding& rounding, std::span<Out> out) {
    bool good = true;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        good &= round_one(boxes[i], padding.empty() ? 0 : padding[i], rounding, out[i]);
    }
    return good;
}

#endif

bool round_narrow_simd(std::span<const Box3f> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                       std::span<Entry> out) {
    return round_boxes_simd(boxes, padding, rounding, out);
}
bool round_wide_simd(std::span<const Box3d> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                     std::span<Entry> out) {
    return round_boxes_simd(boxes, padding, rounding, out);
}
bool round_narrow_boxes_simd(std::span<const Box3f> boxes, std::span<const double> padding,
                             const OutwardRounding& rounding, std::span<Box3f> out) {
    return round_boxes_simd(boxes, padding, rounding, out);
}
bool round_wide_boxes_simd(std::span<const Box3d> boxes, std::span<const double> padding,
                           const OutwardRounding& rounding, std::span<Box3f> out) {
    return round_boxes_simd(boxes, padding, rounding, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(round_narrow_simd);
HWY_EXPORT(round_wide_simd);
HWY_EXPORT(round_narrow_boxes_simd);
HWY_EXPORT(round_wide_boxes_simd);

bool round_boxes(std::span<const Box3f> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Entry> out) {
    return HWY_DYNAMIC_DISPATCH(round_narrow_simd)(boxes, padding, rounding, out);
}

bool round_boxes(std::span<const Box3d> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Entry> out) {
    return HWY_DYNAMIC_DISPATCH(round_wide_simd)(boxes, padding, rounding, out);
}

bool round_boxes(std::span<const Box3f> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Box3f> out) {
    return HWY_DYNAMIC_DISPATCH(round_narrow_boxes_simd)(boxes, padding, rounding, out);
}

bool round_boxes(std::span<const Box3d> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Box3f> out) {
    return HWY_DYNAMIC_DISPATCH(round_wide_boxes_simd)(boxes, padding, rounding, out);
}

HWY_EXPORT(bound_triangles_simd);

bool bound_triangles(std::span<const Triangle3d> triangles, std::span<Box3f> boxes) {
    return HWY_DYNAMIC_DISPATCH(bound_triangles_simd)(triangles, boxes);
}

}  // namespace octopair

#endif  // HWY_ONCE
