// One text for both: with numbers of one pair it is the specification, with vectors of many the fast version.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/exact/pair_look.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "geometry/exact/orientation.hpp"
#include "geometry/exact/pair_look.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <typename D>
class Look {
public:
    using V = hn::Vec<D>;
    using M = hn::Mask<D>;
    struct Corner {
        V x, y, z;
    };
    struct Corners {
        Corner at[3];
    };

    Look(const Corners& a, const Corners& b) : a_(a), b_(b) {
        for (int i = 0; i < 3; ++i) a_shared_[i] = hn::Or(same(i, 0), hn::Or(same(i, 1), same(i, 2)));
        for (int j = 0; j < 3; ++j) b_shared_[j] = hn::Or(same(0, j), hn::Or(same(1, j), same(2, j)));
    }

    M shared() const { return hn::Or(a_shared_[0], hn::Or(a_shared_[1], a_shared_[2])); }
    M apart() const {
        const M beside = hn::Or(beside_plane(a_, a_shared_, b_), beside_plane(b_, b_shared_, a_));
        return hn::Or(beside, middles_apart());
    }

private:
    static V add(const V& x, const V& y, const V& z) { return hn::Add(hn::Add(x, y), z); }
    static V set(double value) { return hn::Set(D(), value); }
    static Corner way(const Corner& from, const Corner& to) {
        return {hn::Sub(to.x, from.x), hn::Sub(to.y, from.y), hn::Sub(to.z, from.z)};
    }

    M same(int i, int j) const {
        const Corner &a = a_.at[i], &b = b_.at[j];
        return hn::And(hn::Eq(a.x, b.x), hn::And(hn::Eq(a.y, b.y), hn::Eq(a.z, b.z)));
    }

    /// A coordinate of a cross product, and the sum of its terms' sizes.
    struct Term {
        V value, size;
        Term(const V& b_u, const V& c_v, const V& b_v, const V& c_u) {
            const V left = hn::Mul(b_u, c_v), right = hn::Mul(b_v, c_u);
            value = hn::Sub(left, right);
            size = hn::Add(hn::Abs(left), hn::Abs(right));
        }
    };

    /// PlaneSides of the corners that are not shared: on the same side, and there are some.
    static M beside_plane(const Corners& of, const M (&shared)[3], const Corners& plane) {
        const Corner b = way(plane.at[0], plane.at[1]), c = way(plane.at[0], plane.at[2]);
        const Term x(b.y, c.z, b.z, c.y), y(b.z, c.x, b.x, c.z), z(b.x, c.y, b.y, c.x);
        M above = hn::Not(hn::And(shared[0], hn::And(shared[1], shared[2]))), below = above;
        for (int i = 0; i < 3; ++i) {
            const Corner d = way(plane.at[0], of.at[i]);
            const V sum = add(hn::Mul(d.x, x.value), hn::Mul(d.y, y.value), hn::Mul(d.z, z.value));
            const Corner size = {hn::Abs(d.x), hn::Abs(d.y), hn::Abs(d.z)};
            const V permanent = add(hn::Mul(size.x, x.size), hn::Mul(size.y, y.size), hn::Mul(size.z, z.size));
            const V lost = hn::Mul(set(filter::underflow), hn::Add(set(1), add(size.x, size.y, size.z)));
            const V error = hn::Add(hn::Mul(set(filter::plane_error), permanent), lost);
            above = hn::And(above, hn::Or(shared[i], hn::Gt(sum, error)));
            below = hn::And(below, hn::Or(shared[i], hn::Lt(sum, hn::Neg(error))));
        }
        return hn::Or(above, below);
    }

    static M at_most_one(const M (&shared)[3]) {
        const M first_two = hn::And(shared[0], shared[1]);
        return hn::Not(hn::Or(first_two, hn::And(hn::Or(shared[0], shared[1]), shared[2])));
    }

    static Corner sum(const Corners& corners) {
        const Corner &a = corners.at[0], &b = corners.at[1], &c = corners.at[2];
        return {add(a.x, b.x, c.x), add(a.y, b.y, c.y), add(a.z, b.z, c.z)};
    }

    /// Distances along a direction err by at most four roundings of the sum of their terms' sizes; the direction's own
    /// roundings do not matter. The shared corner has one distance, whichever triangle it is taken of.
    M middles_apart() const {
        const Corner direction = way(sum(b_), sum(a_));
        V sizes = set(0);
        const auto along = [&](const Corner& corner) {
            const Corner d = way(a_.at[0], corner);
            const V x = hn::Mul(direction.x, d.x), y = hn::Mul(direction.y, d.y), z = hn::Mul(direction.z, d.z);
            sizes = hn::Add(sizes, add(hn::Abs(x), hn::Abs(y), hn::Abs(z)));
            return add(x, y, z);
        };
        const V infinite = set(std::numeric_limits<double>::infinity());
        V low = infinite, high = hn::Neg(infinite), at_shared = set(0);
        for (int i = 0; i < 3; ++i) {
            const V a = along(a_.at[i]), b = along(b_.at[i]);
            low = hn::Min(low, hn::IfThenElse(a_shared_[i], infinite, a));
            high = hn::Max(high, hn::IfThenElse(b_shared_[i], hn::Neg(infinite), b));
            at_shared = hn::IfThenElse(a_shared_[i], a, at_shared);
        }
        const V error = hn::Add(hn::Mul(set(0x1p-49), sizes), set(filter::underflow));
        const V below_low = hn::IfThenElse(shared(), at_shared, high),
                above_high = hn::IfThenElse(shared(), at_shared, low);
        const M apart = hn::And(hn::Gt(hn::Sub(low, below_low), error), hn::Gt(hn::Sub(above_high, high), error));
        return hn::And(apart, hn::And(at_most_one(a_shared_), at_most_one(b_shared_)));
    }

    const Corners &a_, &b_;
    M a_shared_[3], b_shared_[3];
};

template <typename D>
typename Look<D>::Corners gather(D d, std::span<const Triangle3d> triangles, const std::int64_t* first_numbers) {
    const auto numbers = hn::Load(hn::RebindToSigned<D>(), first_numbers);
    const double* base = triangles[0][0].data();
    const auto corner = [&](int i) {
        return typename Look<D>::Corner{hn::GatherIndex(d, base + 3 * i, numbers),
                                        hn::GatherIndex(d, base + 3 * i + 1, numbers),
                                        hn::GatherIndex(d, base + 3 * i + 2, numbers)};
    };
    return {{corner(0), corner(1), corner(2)}};
}

/// Triangles are asked for so many pairs before they are needed.
constexpr std::size_t far_ahead = 32;

void prefetch(const Triangle3d& triangle) {
    hwy::Prefetch(triangle.data());
    hwy::Prefetch(triangle.data() + 2);
}

template <typename D>
void look_with(D d, const TrianglePairs& triangles, std::span<std::uint8_t> looks) {
    constexpr std::size_t most_lanes = hn::MaxLanes(D());
    const std::size_t lanes = hn::Lanes(d);
    HWY_ALIGN std::int64_t a[most_lanes], b[most_lanes];
    std::uint8_t apart[most_lanes / 8 + 8], shared[most_lanes / 8 + 8];
    const auto pairs = triangles.pairs;
    for (std::size_t begin = 0; begin < pairs.size(); begin += lanes) {
        const std::size_t count = std::min(lanes, pairs.size() - begin);
        for (std::size_t i = 0; i < lanes; ++i) {
            const Pair pair = pairs[begin + std::min(i, count - 1)];
            const Pair soon = pairs[std::min(begin + far_ahead + i, pairs.size() - 1)];
            prefetch(triangles.first[soon.a]);
            prefetch(triangles.second[soon.b]);
            a[i] = std::int64_t(pair.a) * 9;
            b[i] = std::int64_t(pair.b) * 9;
        }
        const auto a_corners = gather(d, triangles.first, a), b_corners = gather(d, triangles.second, b);
        const Look<D> look(a_corners, b_corners);
        hn::StoreMaskBits(d, look.apart(), apart);
        hn::StoreMaskBits(d, look.shared(), shared);
        for (std::size_t i = 0; i < count; ++i) {
            const unsigned is_apart = apart[i / 8] >> (i % 8) & 1, is_shared = shared[i / 8] >> (i % 8) & 1;
            looks[begin + i] = std::uint8_t(is_apart * look_apart | is_shared * look_shared);
        }
    }
}

void look_at_simd(const TrianglePairs& triangles, std::span<std::uint8_t> looks) {
    look_with(hn::ScalableTag<double>(), triangles, looks);
}

void look_at_one(const TrianglePairs& triangles, std::span<std::uint8_t> looks) {
    look_with(hn::CappedTag<double, 1>(), triangles, looks);
}

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(look_at_simd);

void look_at(const TrianglePairs& triangles, std::span<std::uint8_t> looks) {
    if (!triangles.pairs.empty()) HWY_DYNAMIC_DISPATCH(look_at_simd)(triangles, looks);
}

std::uint8_t look_at(const Triangle3d& a, const Triangle3d& b) {
    const Pair pair = {0, 0};
    std::uint8_t look = 0;
    HWY_STATIC_DISPATCH(look_at_one)({{&a, 1}, {&b, 1}, {&pair, 1}}, {&look, 1});
    return look;
}

}  // namespace octopair

#endif
