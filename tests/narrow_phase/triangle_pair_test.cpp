// Tests pairs of triangles without tolerance, against rational numbers and against transformations that must not change
// the result.
#include "narrow_phase/exact/triangle_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <random>

#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/triangle_prefilter.hpp"
#include "narrow_phase/exact_oracle.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr double huge = 1.7e308;

/// Returns the side computed in float64 only.
int rounded_plane_side(const std::array<Point3d, 4>& at) {
    std::array<Point3d, 3> to;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) to[i][axis] = at[i + 1][axis] - at[0][axis];
    }
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        sum += to[0][i] * (to[1][(i + 1) % 3] * to[2][(i + 2) % 3] - to[1][(i + 2) % 3] * to[2][(i + 1) % 3]);
    }
    return int(sum > 0) - int(sum < 0);
}

TEST(Orientation, IsThatOfRationalNumbers) {
    std::mt19937 random(1);
    unsigned misjudged = 0, zero = 0;
    for (unsigned i = 0; i < scaled(4000, 10); ++i) {
        const auto [a, b] = some_pair(i % pair_kinds, random);
        const std::array<Point3d, 4> corners = {a[0], b[0], b[1], b[2]};
        const int expected = oracle_plane_side(corners);
        ASSERT_EQ(plane_side(corners[0], corners[1], corners[2], corners[3]), expected) << text({a, b});
        misjudged += unsigned(rounded_plane_side(corners) != expected);
        zero += unsigned(expected == 0);
    }
    EXPECT_GT(misjudged, scaled(200, 10));
    EXPECT_GT(zero, scaled(200, 10));
}

TEST(Orientation, HoldsAtTheEndsOfFloat64) {
    constexpr double tiny = 5e-324;
    EXPECT_EQ(plane_side({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}), 1);
    EXPECT_EQ(plane_side({0, 0, 0}, {0, tiny, 0}, {tiny, 0, 0}, {0, 0, tiny}), -1);
    EXPECT_EQ(plane_side({-huge, 0, 0}, {huge, 0, 0}, {0, huge, 0}, {0, 0, huge}), 1);
    EXPECT_EQ(plane_side({-huge, -huge, tiny}, {huge, -huge, tiny}, {-huge, huge, tiny}, {0, 0, 0}), -1);
    EXPECT_EQ(plane_side({-huge, -huge, tiny}, {huge, -huge, tiny}, {-huge, huge, tiny}, {huge, huge, tiny}), 0);
    EXPECT_EQ(line_side({0, 0, 0}, {tiny, tiny, 0}, {huge, huge, 0}, 2), 0);
    EXPECT_EQ(line_side({0, 0, 0}, {tiny, tiny, 0}, {std::nextafter(huge, 0), huge, 0}, 2), 1);
    EXPECT_EQ(line_side({0, 0, -huge}, {0, tiny, huge}, {0, 0, huge}, 0), 1);
}

TEST(TrianglePair, MeetsWhereRationalNumbersDo) {
    std::mt19937 random(2);
    std::array<unsigned, 2> seen = {}, beyond = {};
    for (unsigned i = 0; i < scaled(1200, 10); ++i) {
        const auto pair = some_pair(i % pair_kinds, random);
        const bool meet = oracle_meet(pair[0], pair[1]);
        ASSERT_EQ(triangles_meet(pair[0], pair[1]), meet) << text(pair);
        ++seen[meet];
        const bool meet_beyond = oracle_meet_beyond(pair[0], pair[1]);
        ASSERT_EQ(meet_beyond_shared(pair[0], pair[1]), meet_beyond) << text(pair);
        if (meet) ++beyond[meet_beyond];
    }
    for (const unsigned some : {seen[0], seen[1], beyond[0], beyond[1]}) EXPECT_GT(some, scaled(90, 10));
}

TEST(TrianglePrefilter, SaysNothingWrongAndTheSameOfOneAsOfMany) {
    std::mt19937 random(10);
    std::vector<Triangle3d> first, second;
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < scaled(40003, 20); ++i) {
        const auto [a, b] = some_pair(i % pair_kinds, random);
        first.push_back(a);
        second.push_back(b);
        pairs.push_back({i, i});
    }
    std::shuffle(pairs.begin(), pairs.end(), random);
    for (Pair& pair : pairs) pair.b = pair.a;
    std::vector<std::uint8_t> flags(pairs.size());
    prefilter_pairs({first, second, pairs}, flags);
    std::array<std::size_t, 4> seen = {};
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Triangle3d &a = first[pairs[i].a], &b = second[pairs[i].b];
        ASSERT_EQ(flags[i], prefilter_pair(a, b)) << text({a, b});
        ASSERT_EQ((flags[i] & prefilter_shared) != 0, oracle_shared_corners(a, b) != 0) << text({a, b});
        ASSERT_FALSE((flags[i] & prefilter_apart) != 0 && meet_beyond_shared(a, b)) << text({a, b});
        ++seen[flags[i]];
    }
    for (const std::size_t some : seen) EXPECT_GT(some, pairs.size() / 50);
}

TEST(TrianglePrefilter, SaysNothingWrongWhereProductsOverflowOrVanish) {
    std::mt19937 random(11);
    for (const int exponent : {-1070, -700, -360, -300, 300, 336, 339, 342, 500, 508, 512, 700, 1015}) {
        for (std::uint32_t i = 0; i < scaled(2000, 20); ++i) {
            auto [a, b] = some_pair(i % pair_kinds, random);
            for (Triangle3d* triangle : {&a, &b}) {
                for (Point3d& corner : *triangle) {
                    for (double& at : corner) at = std::clamp(std::ldexp(at, exponent), -DBL_MAX, DBL_MAX);
                }
            }
            const std::uint8_t flags = prefilter_pair(a, b);
            ASSERT_EQ((flags & prefilter_shared) != 0, oracle_shared_corners(a, b) != 0) << text({a, b});
            ASSERT_FALSE((flags & prefilter_apart) != 0 && meet_beyond_shared(a, b)) << text({a, b});
        }
    }
}

/// Returns the pair with triangles, corners and axes in random order, and in half of the cases mirrored.
TrianglePair rearranged(TrianglePair pair, std::mt19937& random) {
    std::array<std::size_t, 3> axes = {0, 1, 2};
    std::shuffle(axes.begin(), axes.end(), random);
    const double mirror = random() % 2 == 0 ? 1 : -1;
    for (auto& triangle : pair) {
        std::shuffle(triangle.begin(), triangle.end(), random);
        for (Point3d& corner : triangle) corner = {mirror * corner[axes[0]], corner[axes[1]], corner[axes[2]]};
    }
    if (random() % 2 == 0) std::swap(pair[0], pair[1]);
    return pair;
}

TEST(TrianglePair, DoesNotDependOnOrderSidesOrMirrors) {
    std::mt19937 random(3);
    for (unsigned i = 0; i < scaled(40000, 20); ++i) {
        const auto pair = some_pair(i % pair_kinds, random);
        const auto other = rearranged(pair, random);
        ASSERT_EQ(triangles_meet(pair[0], pair[1]), triangles_meet(other[0], other[1])) << text(pair);
        ASSERT_EQ(meet_beyond_shared(pair[0], pair[1]), meet_beyond_shared(other[0], other[1])) << text(pair);
        ASSERT_EQ(prefilter_pair(pair[0], pair[1]) & prefilter_shared,
                  prefilter_pair(other[0], other[1]) & prefilter_shared)
            << text(pair);
    }
}

struct KnownPair {
    const char* name;
    TrianglePair pair;
    unsigned shared;
    bool meet, beyond;
};

constexpr Triangle3d flat = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};

const std::array<KnownPair, 20> known_pairs = {{
    {"equal", {flat, flat}, 3, true, true},
    {"a segment, twice", {{{{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}}, {{{3, 3, 3}, {0, 0, 0}, {1, 1, 1}}}}}, 3, true, false},
    {"a point, twice", {{{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}, {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}}}, 1, true, false},
    {"a point inside", {{flat, {{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}}}}, 0, true, true},
    {"a point beside", {{flat, {{{1, 1, 5e-324}, {1, 1, 5e-324}, {1, 1, 5e-324}}}}}, 0, false, false},
    {"a segment through", {{flat, {{{1, 1, -1}, {1, 1, 1}, {1, 1, 0}}}}}, 0, true, true},
    {"a segment in the plane", {{flat, {{{-1, 1, 0}, {9, 1, 0}, {5, 1, 0}}}}}, 0, true, true},
    {"a segment from a corner, inward", {{flat, {{{0, 0, 0}, {1, 1, 0}, {0, 0, 0}}}}}, 1, true, true},
    {"a segment from a corner, outward", {{flat, {{{0, 0, 0}, {-1, 1, 0}, {-1, 1, 0}}}}}, 1, true, false},
    {"an edge as a segment", {{flat, {{{0, 0, 0}, {4, 0, 0}, {0, 0, 0}}}}}, 2, true, false},
    {"a longer edge", {{flat, {{{0, 0, 0}, {4, 0, 0}, {5, 0, 0}}}}}, 2, true, false},
    {"two longer edges, both ways",
     {{{{{0, 0, 0}, {4, 0, 0}, {5, 0, 0}}}, {{{0, 0, 0}, {4, 0, 0}, {-1, 0, 0}}}}},
     2,
     true,
     false},
    {"two longer edges, one way",
     {{{{{0, 0, 0}, {4, 0, 0}, {5, 0, 0}}}, {{{0, 0, 0}, {4, 0, 0}, {6, 0, 0}}}}},
     2,
     true,
     true},
    {"folded over an edge", {{flat, {{{4, 0, 0}, {0, 0, 0}, {1, 1, 0}}}}}, 2, true, true},
    {"across an edge", {{flat, {{{4, 0, 0}, {0, 0, 0}, {1, -1, 0}}}}}, 2, true, false},
    {"bent over an edge", {{flat, {{{4, 0, 0}, {0, 0, 0}, {1, 1, 1e-300}}}}}, 2, true, false},
    {"through, from a corner", {{flat, {{{0, 0, 0}, {2, 2, 1}, {2, 2, -1}}}}}, 1, true, true},
    {"along an edge, from a corner", {{flat, {{{0, 0, 0}, {9, 0, 0}, {2, -2, -1}}}}}, 1, true, true},
    {"away, from a corner", {{flat, {{{0, 0, 0}, {-2, -2, 1}, {-2, -2, -1}}}}}, 1, true, false},
    {"corner in an edge", {{flat, {{{2, 2, 0}, {5, 5, 0}, {5, 5, 1}}}}}, 0, true, true},
}};

TEST(TrianglePair, DecidesPairsMadeByHand) {
    for (const KnownPair& known : known_pairs) {
        const auto& [a, b] = known.pair;
        EXPECT_EQ(triangles_meet(a, b), known.meet) << known.name;
        EXPECT_EQ(meet_beyond_shared(a, b), known.beyond) << known.name;
        EXPECT_EQ((prefilter_pair(a, b) & prefilter_shared) != 0, known.shared != 0) << known.name;
        EXPECT_EQ(oracle_shared_corners(a, b), known.shared) << known.name;
        EXPECT_EQ(oracle_meet(a, b), known.meet) << known.name;
        EXPECT_EQ(oracle_meet_beyond(a, b), known.beyond) << known.name;
    }
}

}  // namespace
}  // namespace octopair::test
