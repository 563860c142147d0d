// prefilter_pair() and prefilter_pairs(), from one template: with one lane it is the specification, with SIMD vectors the fast
// version.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "narrow_phase/exact/triangle_prefilter.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <limits>

#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/triangle_prefilter.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <typename D>
class PairPrefilter {
public:
    using V = hn::Vec<D>;
    using M = hn::Mask<D>;
    struct Corner {
        V x, y, z;
    };
    struct Corners {
        Corner at[3];
    };

    PairPrefilter(const Corners& a, const Corners& b) {
        M same[3][3];
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) same[i][j] = equal(a.at[i], b.at[j]);
        }
        for (int i = 0; i < 3; ++i) {
            a_shared_[i] = hn::Or(same[i][0], hn::Or(same[i][1], same[i][2]));
            b_shared_[i] = hn::Or(same[0][i], hn::Or(same[1][i], same[2][i]));
        }
        for (int i = 0; i < 3; ++i) {
            a_.at[i] = i == 0 ? Corner{set(0), set(0), set(0)} : way(a.at[0], a.at[i]);
            b_.at[i] = way(a.at[0], b.at[i]);
        }
        largest_ = hn::Max(largest(a_.at[1]), largest(a_.at[2]));
        for (const Corner& corner : b_.at) largest_ = hn::Max(largest_, largest(corner));
    }

    M shared() const { return hn::Or(a_shared_[0], hn::Or(a_shared_[1], a_shared_[2])); }
    M apart() const { return hn::Or(hn::Or(b_beside_a(), a_beside_b()), middles_apart()); }

private:
    static V set(double value) { return hn::Set(D(), value); }
    static V add(const V& x, const V& y, const V& z) { return hn::Add(hn::Add(x, y), z); }
    static V largest(const Corner& corner) {
        return hn::Max(hn::Max(hn::Abs(corner.x), hn::Abs(corner.y)), hn::Abs(corner.z));
    }
    static M equal(const Corner& a, const Corner& b) {
        return hn::And(hn::Eq(a.x, b.x), hn::And(hn::Eq(a.y, b.y), hn::Eq(a.z, b.z)));
    }
    static Corner way(const Corner& from, const Corner& to) {
        return {hn::Sub(to.x, from.x), hn::Sub(to.y, from.y), hn::Sub(to.z, from.z)};
    }
    static V dot(const Corner& a, const Corner& b) {
        return add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z));
    }
    static Corner cross(const Corner& a, const Corner& b) {
        return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
                hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
    }

    /// Returns an upper bound on the error of a height over a plane. The error is below 2^-43 * m^3, where m is the largest
    /// coordinate. In units of 2^-53, coordinates err by m and the edges between b's corners by 4 m. A coordinate of their
    /// cross product errs by 48 m^2, a scalar product with a corner by 240 m^3. No sum exceeds 48 m^3, so an overflow makes
    /// the bound infinite.
    V height_error() const {
        const V power = hn::Mul(hn::Mul(largest_, set(64)), hn::Mul(largest_, largest_));
        return hn::Add(hn::Mul(power, set(0x1p-42 / 64)), lost());
    }
    V lost() const { return hn::Mul(set(filter::underflow), hn::Add(set(1), largest_)); }

    /// Returns true if all corners that are not shared are on the same side of the plane, and at least one is not shared.
    M on_one_side(const V (&heights)[3], const M (&shared)[3]) const {
        const V error = height_error(), below_error = hn::Neg(error);
        M above = hn::Not(hn::And(shared[0], hn::And(shared[1], shared[2]))), below = above;
        for (int i = 0; i < 3; ++i) {
            above = hn::And(above, hn::Or(shared[i], hn::Gt(heights[i], error)));
            below = hn::And(below, hn::Or(shared[i], hn::Lt(heights[i], below_error)));
        }
        return hn::Or(above, below);
    }

    M b_beside_a() const {
        const Corner normal = cross(a_.at[1], a_.at[2]);
        const V heights[3] = {dot(normal, b_.at[0]), dot(normal, b_.at[1]), dot(normal, b_.at[2])};
        return on_one_side(heights, b_shared_);
    }

    M a_beside_b() const {
        const Corner normal = cross(way(b_.at[0], b_.at[1]), way(b_.at[0], b_.at[2]));
        const V plane = dot(normal, b_.at[0]);
        const V heights[3] = {hn::Neg(plane), hn::Sub(dot(normal, a_.at[1]), plane),
                              hn::Sub(dot(normal, a_.at[2]), plane)};
        return on_one_side(heights, a_shared_);
    }

    static M at_most_one(const M (&shared)[3]) {
        const M first_two = hn::And(shared[0], shared[1]);
        return hn::Not(hn::Or(first_two, hn::And(hn::Or(shared[0], shared[1]), shared[2])));
    }

    static Corner sum(const Corners& corners) {
        const Corner &a = corners.at[0], &b = corners.at[1], &c = corners.at[2];
        return {add(a.x, b.x, c.x), add(a.y, b.y, c.y), add(a.z, b.z, c.z)};
    }

    /// Returns true if a plane perpendicular to the line between the centroids separates the triangles. Rounding of the
    /// direction does not matter. Its coordinates are at most 6 m, where m is the largest coordinate. So a difference of two
    /// positions along it is below 36 m^2 and errs by less than 2^-45 m^2. The shared corner has the same position in both
    /// triangles.
    M middles_apart() const {
        const Corner direction = way(sum(b_), sum(a_));
        const V infinite = set(std::numeric_limits<double>::infinity());
        V low = infinite, high = hn::Neg(infinite), at_shared = set(0);
        for (int i = 0; i < 3; ++i) {
            const V a = i == 0 ? set(0) : dot(direction, a_.at[i]), b = dot(direction, b_.at[i]);
            low = hn::Min(low, hn::IfThenElse(a_shared_[i], infinite, a));
            high = hn::Max(high, hn::IfThenElse(b_shared_[i], hn::Neg(infinite), b));
            at_shared = hn::IfThenElse(a_shared_[i], a, at_shared);
        }
        const V square = hn::Mul(hn::Mul(largest_, set(64)), largest_);
        const V error = hn::Add(hn::Mul(square, set(0x1p-44 / 64)), set(filter::underflow));
        const V below_low = hn::IfThenElse(shared(), at_shared, high),
                above_high = hn::IfThenElse(shared(), at_shared, low);
        const M apart = hn::And(hn::Gt(hn::Sub(low, below_low), error), hn::Gt(hn::Sub(above_high, high), error));
        return hn::And(apart, hn::And(at_most_one(a_shared_), at_most_one(b_shared_)));
    }

    Corners a_, b_;  // relative to a's first corner
    V largest_;      // largest absolute coordinate of a_ and b_
    M a_shared_[3], b_shared_[3];
};

template <typename D>
HWY_INLINE typename PairPrefilter<D>::Corners gather(D d, std::span<const Triangle3d> triangles,
                                                     hn::Vec<hn::RebindToSigned<D>> first_numbers) {
    const double* base = triangles[0][0].data();
    const auto corner = [&](int i) HWY_ATTR {
        return typename PairPrefilter<D>::Corner{hn::GatherIndex(d, base + 3 * i, first_numbers),
                                                 hn::GatherIndex(d, base + 3 * i + 1, first_numbers),
                                                 hn::GatherIndex(d, base + 3 * i + 2, first_numbers)};
    };
    return {{corner(0), corner(1), corner(2)}};
}

/// Number of pairs by which triangles are prefetched ahead.
constexpr std::size_t prefetch_distance = 32;

HWY_INLINE void prefetch(const Triangle3d& triangle) {
    hwy::Prefetch(triangle.data());
    hwy::Prefetch(triangle.data() + 2);
}

/// Tests as many pairs as the vector has lanes.
template <typename D>
HWY_INLINE void prefilter_lanes(D d, const TrianglePairs& triangles, const Pair* pairs, std::uint8_t* flags) {
    const hn::RebindToSigned<D> numbers;
    HWY_ALIGN std::int64_t a[hn::MaxLanes(D())], b[hn::MaxLanes(D())];
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
        a[i] = pairs[i].a;
        b[i] = pairs[i].b;
    }
    const auto first_number = [&](const std::int64_t* triangle) HWY_ATTR {
        const auto number = hn::Load(numbers, triangle);
        return hn::Add(hn::ShiftLeft<3>(number), number);
    };
    const auto a_corners = gather(d, triangles.first, first_number(a));
    const auto b_corners = gather(d, triangles.second, first_number(b));
    const PairPrefilter<D> test(a_corners, b_corners);
    const hn::RebindToUnsigned<D> words;
    const auto apart = hn::IfThenElseZero(hn::RebindMask(words, test.apart()), hn::Set(words, prefilter_apart));
    const auto shared = hn::IfThenElseZero(hn::RebindMask(words, test.shared()), hn::Set(words, prefilter_shared));
    const hn::Rebind<std::uint8_t, D> bytes;
    hn::StoreU(hn::TruncateTo(bytes, hn::Or(apart, shared)), bytes, flags);
}

template <typename D>
void prefilter_with(D d, const TrianglePairs& triangles, std::span<std::uint8_t> flags) {
    const std::size_t lanes = hn::Lanes(d);
    const auto pairs = triangles.pairs;
    std::size_t begin = 0;
    for (; begin + lanes <= pairs.size(); begin += lanes) {
        for (std::size_t i = 0; i < lanes; ++i) {
            const Pair soon = pairs[std::min(begin + prefetch_distance + i, pairs.size() - 1)];
            prefetch(triangles.first[soon.a]);
            prefetch(triangles.second[soon.b]);
        }
        prefilter_lanes(d, triangles, &pairs[begin], &flags[begin]);
    }
    if (begin == pairs.size()) return;
    std::array<Pair, hn::MaxLanes(D())> last;
    std::array<std::uint8_t, hn::MaxLanes(D())> last_flags;
    last.fill(pairs.back());
    std::copy(pairs.begin() + std::ptrdiff_t(begin), pairs.end(), last.begin());
    prefilter_lanes(d, triangles, last.data(), last_flags.data());
    std::copy_n(last_flags.begin(), pairs.size() - begin, flags.begin() + std::ptrdiff_t(begin));
}

void prefilter_simd(const TrianglePairs& triangles, std::span<std::uint8_t> flags) {
    prefilter_with(hn::ScalableTag<double>(), triangles, flags);
}

void prefilter_one(const TrianglePairs& triangles, std::span<std::uint8_t> flags) {
    prefilter_with(hn::CappedTag<double, 1>(), triangles, flags);
}

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(prefilter_simd);

void prefilter_pairs(const TrianglePairs& triangles, std::span<std::uint8_t> flags) {
    if (!triangles.pairs.empty()) HWY_DYNAMIC_DISPATCH(prefilter_simd)(triangles, flags);
}

std::uint8_t prefilter_pair(const Triangle3d& a, const Triangle3d& b) {
    const Pair pair = {0, 0};
    std::uint8_t flags = 0;
    HWY_STATIC_DISPATCH(prefilter_one)({{&a, 1}, {&b, 1}, {&pair, 1}}, {&flags, 1});
    return flags;
}

}  // namespace octopair

#endif
