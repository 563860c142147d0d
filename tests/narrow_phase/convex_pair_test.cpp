// Tests pairs of convex shapes: random shapes against the oracle, and cases that are known to break solvers.
#include "narrow_phase/convex/convex_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "narrow_phase/convex_oracle.hpp"
#include "narrow_phase/convex_things.hpp"
#include "samples/meshes.hpp"
#include "samples/random.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using samples::random_pose;
using samples::RandomStream;
using vector::dot;
using vector::length;
using vector::minus;
using vector::plus;
using vector::times;

void expect_apart(const Thing& a, const Thing& b) {
    const ConvexGap found = convex_gap(a.convex(), b.convex()), back = convex_gap(b.convex(), a.convex());
    EXPECT_EQ(back.distance, found.distance);
    EXPECT_EQ(back.on_a, found.on_b);
    EXPECT_LT(a.off(found.on_a), 1e-9);
    EXPECT_LT(b.off(found.on_b), 1e-9);
    EXPECT_NEAR(length(minus(found.on_b, found.on_a)), found.distance, 1e-9);
    EXPECT_LE(found.at_least, found.distance);
    EXPECT_LT(found.distance - found.at_least, 1e-8);
    const double oracle = distance_by_turns(a.posed, b.posed, 300);
    EXPECT_LE(found.at_least, oracle + 1e-12);
    EXPECT_TRUE(convex_within(a.convex(), b.convex(), oracle + 1e-12));
    EXPECT_FALSE(convex_within(a.convex(), b.convex(), found.at_least * 0.999999 - 1e-9));
}

void expect_overlap(const Thing& a, const Thing& b, RandomStream& random) {
    EXPECT_EQ(gap(a, b), 0);
    const ConvexContact found = contact(a, b);
    EXPECT_NEAR(length(found.normal), 1, 1e-12);
    EXPECT_FALSE(meet(a, b.moved(times(found.normal, found.depth + 1e-9))));
    EXPECT_LT(std::max(a.off(found.point), b.off(found.point)), 1e-9);
    // No shorter translation separates the shapes.
    for (int i = 0; i < 10; ++i) {
        const Point3d way = random_point(random);
        EXPECT_TRUE(meet(a, b.moved(times(way, 0.999 * found.depth / length(way)))));
    }
}

TEST(ConvexPair, EveryShapeAgainstEveryShape) {
    RandomStream random(5, 0);
    int meeting = 0, apart = 0;
    for (int kind_a = 0; kind_a < kinds; ++kind_a) {
        for (int kind_b = 0; kind_b < kinds; ++kind_b) {
            SCOPED_TRACE("kinds " + std::to_string(kind_a) + ", " + std::to_string(kind_b));
            for (int i = 0; i < 40 && !::testing::Test::HasFailure(); ++i) {
                const Thing a(random_shape(kind_a, random), random_pose(random, 1.5));
                const Thing b(random_shape(kind_b, random), random_pose(random, 1.5));
                const double oracle = distance_by_turns(a.posed, b.posed, 300);
                const bool found = meet(a, b);
                // The oracle is an upper bound: 0 proves a common point, and a small value proves nothing.
                EXPECT_TRUE(found || oracle >= 1e-12);
                EXPECT_FALSE(found && oracle > 0.02) << oracle;
                found ? ++meeting : ++apart;
                found ? expect_overlap(a, b, random) : expect_apart(a, b);
            }
        }
    }
    EXPECT_GT(meeting, 400);
    EXPECT_GT(apart, 400);
}

TEST(ConvexPair, NearlyTouchingIsToldApart) {
    RandomStream random(6, 0);
    for (int kind_a = 0; kind_a < kinds; ++kind_a) {
        for (int kind_b = 0; kind_b < kinds; ++kind_b) {
            SCOPED_TRACE("kinds " + std::to_string(kind_a) + ", " + std::to_string(kind_b));
            const Thing a(random_shape(kind_a, random), random_pose(random, 1));
            const Thing b = Thing(random_shape(kind_b, random), random_pose(random, 1)).moved({5, 4, 3});
            const ConvexGap found = convex_gap(a.convex(), b.convex());
            const Point3d way = times(minus(found.on_a, found.on_b), 1 / found.distance);
            EXPECT_FALSE(meet(a, b.moved(times(way, found.distance - 1e-7))));
            EXPECT_LT(gap(a, b.moved(times(way, found.distance))), 1e-8);
        }
    }
}

TEST(ConvexPair, KnownDistancesAndDepths) {
    const Thing ball(shape::Sphere{1}), box(shape::Box{{1, 2, 3}}), rod(shape::Capsule{0.5, 2});
    EXPECT_DOUBLE_EQ(gap(ball, ball.moved({3, 4, 0})), 3);
    EXPECT_DOUBLE_EQ(contact(ball, ball.moved({0, 1.5, 0})).depth, 0.5);
    EXPECT_DOUBLE_EQ(gap(box, ball.moved({4, 6, 0})), 4);
    EXPECT_DOUBLE_EQ(gap(rod, ball.moved({3, 0, 0.5})), 1.5);
    EXPECT_DOUBLE_EQ(contact(box, ball.moved({1.5, 0, 0})).depth, 0.5);
    // The ball's centre is in the box. The shortest way out is through the nearest side.
    const ConvexContact deep = contact(box, ball.moved({0.75, 0, 0}));
    EXPECT_DOUBLE_EQ(deep.depth, 1.25);
    EXPECT_NEAR(deep.normal[0], 1, 1e-12);
    // Capsules whose axes cross.
    const Thing across(shape::Capsule{0.5, 2}, make_pose({0, 0, 0}, {1, 1, 0, 0}));
    EXPECT_DOUBLE_EQ(contact(rod, across).depth, 1);
    EXPECT_DOUBLE_EQ(gap(rod, across.moved({2, 0, 0})), 1);
}

TEST(ConvexPair, LeastDepthsOfSymmetricAndFlatThings) {
    const Pose turned = make_pose({0, 0, 0}, {1, 1, 1, 1});
    for (const Pose& pose : {Pose{}, turned}) {
        EXPECT_NEAR(contact(Thing(shape::Capsule{2, 4}, pose), Thing(shape::Capsule{0.5, 0.5}, pose)).depth, 2.5,
                    1e-12);
    }
    const Thing cone(shape::Cone{2, 4}), ball(shape::Sphere{0.25}, Point3d{0, 0, -0.25});
    EXPECT_NEAR(contact(cone, ball).depth, 0.25 + 2.25 / std::sqrt(5.0), 1e-12);
    // A plane separates these pairs.
    const Thing flat(shape::ConvexHull{{{0, -2, 0.5}, {0, 2, 0.5}, {-0.5, 0, 1.5}}}, Point3d{-1, 0, -0.5});
    EXPECT_NEAR(contact(Thing(shape::Cone{2, 2}), flat).depth, 0, 1e-14);
    const Thing hull(shape::ConvexHull{{{0.5, 0.5, -0.5}, {0, 0.5, 0}, {-0.5, 0, 0}, {0, 0.5, 0.5}, {0.5, 0, -0.5}}},
                     turned);
    EXPECT_NEAR(contact(hull, Thing(shape::Box{{0.5, 0.5, 0.25}}, Point3d{0.5, -0.75, 0.5})).depth, 0, 1e-14);
}

TEST(ConvexPair, LeastDepthsOfTinyThingsInLargeOnes) {
    // Nearly all directions across the axis have the same overlap.
    const auto depth = [](const shape::Any& large, const std::array<double, 4>& turn, const shape::Any& small,
                          const std::array<double, 4>& small_turn) {
        return contact(Thing(large, make_pose({0, 0, 0}, turn)), Thing(small, make_pose({0, 0, 0}, small_turn))).depth;
    };
    const shape::Any egg = shape::Ellipsoid{{0.001, 0.0008, 0.0013}};
    EXPECT_LT(depth(shape::Cylinder{1, 4}, {2, 1, 1, 1}, egg, {-8, 7, 4, 12}), 1.00097211 + 1e-8);
    EXPECT_LT(depth(shape::Ellipsoid{{1, 1, 3}}, {3, -2, 3, -1}, egg, {3, 22, 20, 2}), 1.00097211 + 1e-8);
    EXPECT_LT(depth(shape::Cylinder{1, 4}, {2, -2, 1, 1}, shape::Cylinder{0.001, 0.001}, {-2, 4, 19, 3}),
              1.00080474 + 1e-8);
    EXPECT_NEAR(depth(shape::Cone{5, 10}, {0.25, -0.63, 0.61, -1.52}, shape::Sphere{1e-4}, {1, 0, 0, 0}),
                std::sqrt(5.0) + 1e-4, 1e-9);
}

/// Least overlap of two things along many directions, improved where it is small.
double least_overlap(const Thing& a, const Thing& b) {
    const auto overlap = [&](const Point3d& way) {
        const auto farthest = [&](const Thing& thing, const Point3d& along) {
            const Point3d own = vector::turned_back(thing.posed.pose, along);
            return dot(vector::posed(thing.posed.pose, support(thing.solid, own)), along) + thing.solid.radius;
        };
        return farthest(a, way) + farthest(b, times(way, -1));
    };
    constexpr int directions = 2000;
    std::vector<std::pair<double, Point3d>> tried;
    for (int i = 0; i < directions; ++i) {
        const double z = 1 - (2 * i + 1.0) / directions, r = std::sqrt(1 - z * z), turn = i * 2.399963229728653;
        const Point3d way = {r * std::cos(turn), r * std::sin(turn), z};
        tried.emplace_back(overlap(way), way);
    }
    std::partial_sort(tried.begin(), tried.begin() + 8, tried.end());
    double least = tried.front().first;
    for (int i = 0; i < 8; ++i) {
        auto [best, way] = tried[std::size_t(i)];
        int turns = 0;
        for (double step = 0.05; step > 1e-9 && turns < 400; ++turns) {
            const Point3d across = length(vector::cross(way, {1, 0, 0})) > 0.5 ? Point3d{1, 0, 0} : Point3d{0, 1, 0};
            const Point3d u = vector::cross(way, across), v = vector::cross(way, u);
            bool better = false;
            for (int turn = 0; turn < 12 && !better; ++turn) {
                Point3d next =
                    plus(way, plus(times(u, step * std::cos(turn * 0.5236)), times(v, step * std::sin(turn * 0.5236))));
                next = times(next, 1 / length(next));
                if (const double at = overlap(next); at < best) best = at, way = next, better = true;
            }
            if (!better) step /= 2;
        }
        least = std::min(least, best);
    }
    return std::max(0.0, least);
}

TEST(ConvexPair, DepthsAreTheLeastInEveryRotation) {
    RandomStream random(14, 0);
    std::uint64_t meeting = 0;
    for (std::uint64_t i = 0; i < scaled(3000, 30) && !::testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE("pair " + std::to_string(i));
        const int kind_a = int(random.below(unsigned(kinds))), kind_b = int(random.below(unsigned(kinds)));
        // Aligned pairs have many directions of equal overlap.
        const bool aligned = i % 2 == 0;
        const auto place = [&] {
            return aligned ? Point3d{double(random.below(5)) / 4 - 0.5, double(random.below(5)) / 4 - 0.5, 0}
                           : random_point(random);
        };
        const Thing a(random_shape(kind_a, random), aligned ? make_pose(place()) : random_pose(random, 1));
        const Thing b(random_shape(kind_b, random), aligned ? make_pose(place()) : random_pose(random, 1));
        if (!meet(a, b)) continue;
        ++meeting;
        const double depth = contact(a, b).depth;
        EXPECT_LE(depth, least_overlap(a, b) + 1e-6);
        EXPECT_EQ(contact(b, a).depth, depth);
        const Pose turn = random_pose(random, 0);
        const auto turned = [&](const Thing& thing) {
            Pose pose;
            for (std::size_t row = 0; row < 3; ++row) {
                for (std::size_t column = 0; column < 4; ++column) {
                    double sum = column == 3 ? turn.rows[row][3] : 0;
                    for (std::size_t k = 0; k < 3; ++k) sum += turn.rows[row][k] * thing.posed.pose.rows[k][column];
                    pose.rows[row][column] = sum;
                }
            }
            return Thing(thing.posed.shape, pose);
        };
        EXPECT_NEAR(contact(turned(a), turned(b)).depth, depth, 1e-6);
    }
    EXPECT_GT(meeting, scaled(1000, 30));
}

/// A convex polyhedron with integer corners, turned by an integer map: (1, 2, 2, 0) and the like, exact in rationals.
struct Turned {
    std::array<int, 4> quaternion;

    Point3d operator()(const Point3d& at) const {
        const auto [w, x, y, z] = quaternion;
        const Point3d rows[] = {{double(w * w + x * x - y * y - z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
                                {2.0 * (x * y + w * z), double(w * w - x * x + y * y - z * z), 2.0 * (y * z - w * x)},
                                {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), double(w * w - x * x - y * y + z * z)}};
        return {dot(rows[0], at), dot(rows[1], at), dot(rows[2], at)};
    }
    double scale() const {
        const auto [w, x, y, z] = quaternion;
        return w * w + x * x + y * y + z * z;
    }
};

TEST(ConvexPair, HullsThatTouchOrPenetrateByConstruction) {
    RandomStream random(15, 0);
    const auto digit = [&](int most) { return double(random.below(unsigned(2 * most + 1))) - most; };
    for (std::uint64_t i = 0; i < scaled(10'000, 30) && !::testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE("pair " + std::to_string(i));
        const Turned turn{{1 + int(random.below(3)), int(digit(2)), int(digit(2)), int(digit(2))}};
        // Corners below and above z = 0, with at least three at z = 0 around the origin: the hulls share a face in part.
        const int deep = int(random.below(3));  // 0: they touch; otherwise they overlap by `deep`
        std::array<std::vector<Point3d>, 2> corners;
        for (const std::size_t side : {0U, 1U}) {
            const double up = side == 0 ? -1 : 1;
            for (const Point3d& foot : {Point3d{4, 1, 0}, Point3d{-4, 3, 0}, Point3d{-3, -4, 0}, Point3d{3, -3, 0}}) {
                corners[side].push_back({foot[0] + digit(1), foot[1] + digit(1), side == 0 ? double(deep) : 0});
            }
            for (int k = 0; k < 3; ++k) {
                corners[side].push_back(
                    {digit(3), digit(3), up * (5 + double(random.below(4))) + (side == 0 ? deep : 0)});
            }
            for (Point3d& corner : corners[side]) corner = turn(corner);
        }
        const Thing a(shape::ConvexHull{corners[0]}), b(shape::ConvexHull{corners[1]});
        EXPECT_TRUE(meet(a, b));
        const double size = 8 * turn.scale();
        EXPECT_NEAR(contact(a, b).depth, deep * turn.scale(), deep == 0 ? 1e-13 * size : 1e-9 * size);
    }
}

TEST(ConvexPair, ContactsAreInThinThingsToo) {
    const Thing ball(shape::Sphere{1}), plate(shape::Box{{0.01, 1, 1}}, Point3d{0.2, 0, 0}),
        bead(shape::Sphere{0.1}, Point3d{0.05, 0, 0});
    EXPECT_NEAR(contact(ball, plate).point[0], 0.19, 1e-12);
    EXPECT_DOUBLE_EQ(contact(ball, plate).depth, 0.81);
    EXPECT_NEAR(contact(ball, bead).point[0], 0.025, 1e-12);
}

TEST(ConvexPair, TouchingMeetsAndAHairBeyondDoesNot) {
    const auto touch_along = [](const Thing& a, const Thing& b, const Point3d& way, double distance) {
        EXPECT_TRUE(meet(a, b.moved(times(way, distance))));
        EXPECT_FALSE(meet(a, b.moved(times(way, distance + 1e-7))));
        EXPECT_LT(contact(a, b.moved(times(way, distance))).depth, 1e-7);
    };
    const Thing box(shape::Box{{0.5, 0.5, 0.5}}), cylinder(shape::Cylinder{0.5, 2}), cone(shape::Cone{0.5, 2});
    const Thing egg(shape::Ellipsoid{{0.3, 0.5, 0.7}}), ball(shape::Sphere{0.25}), rod(shape::Capsule{0.25, 1});
    touch_along(box, box, {1, 0, 0}, 1);
    touch_along(cylinder, cylinder, {0, 0, 1}, 2);
    touch_along(cylinder, cylinder, {0, 1, 0}, 1);
    touch_along(cylinder, box, {1, 0, 0}, 1);
    touch_along(cone, cone, {0, 0, 1}, 2);
    touch_along(cone, egg, {0, 0, 1}, 1.7);
    touch_along(egg, egg, {1, 0, 0}, 0.6);
    touch_along(egg, ball, {0, 1, 0}, 0.75);
    touch_along(rod, rod, {0, 0, 1}, 1.5);
    touch_along(rod, rod, {1, 0, 0}, 0.5);
}

TEST(ConvexPair, InEachOtherOrTheSame) {
    RandomStream random(7, 0);
    for (int kind = 0; kind < kinds; ++kind) {
        SCOPED_TRACE("kind " + std::to_string(kind));
        const Thing thing(random_shape(kind, random), random_pose(random, 2));
        EXPECT_TRUE(meet(thing, thing));
        EXPECT_EQ(gap(thing, thing), 0);
        if (kind == kinds - 1) continue;  // a hull can be a single point, which cannot contain the grain
        const ConvexContact found = contact(thing, thing);
        EXPECT_FALSE(meet(thing, thing.moved(times(found.normal, found.depth + 1e-9))));
        const Thing grain(shape::Sphere{0.01}, thing.posed.pose);
        EXPECT_EQ(gap(thing, grain), 0);
        EXPECT_GT(contact(thing, grain).depth, 0.04);
        EXPECT_TRUE(convex_contains(thing.convex(), grain.convex()));
        EXPECT_FALSE(convex_contains(grain.convex(), thing.convex()));
    }
}

TEST(ConvexPair, FlatHulls) {
    const Thing sheet(shape::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}}});
    const Thing stick(shape::ConvexHull{{{0, 0, 0}, {0, 0, 1}}}), dot(shape::ConvexHull{{{0, 0, 0}}});
    const Thing corner(shape::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    for (const Thing& thing : {sheet, stick, dot, corner}) {
        EXPECT_TRUE(meet(thing, thing));
        EXPECT_EQ(contact(thing, thing).depth, 0) << "any step across a flat shape separates the shapes";
    }
    EXPECT_TRUE(meet(sheet, sheet.moved({1, 1, 0})));
    EXPECT_FALSE(meet(sheet, sheet.moved({1, 1, 1e-9})));
    EXPECT_NEAR(gap(sheet, sheet.moved({0.5, 0, 1e-9})), 1e-9, 1e-13);
    EXPECT_TRUE(meet(sheet, stick.moved({0.25, 0.25, -0.5})));
    EXPECT_TRUE(meet(sheet, dot.moved({0.25, 0.75, 0})));
    EXPECT_FALSE(meet(corner, dot.moved({0.5, 0.500001, 0})));
    EXPECT_TRUE(meet(corner, dot.moved({0.5, 0.5, 0})));
    EXPECT_NEAR(contact(Thing(shape::Box{{1, 1, 1}}), sheet.moved({0, 0, 0.75})).depth, 0.25, 1e-12);
}

TEST(ConvexPair, HugeAgainstTiny) {
    const Thing world(shape::Box{{1e6, 1e6, 1e6}}), grain(shape::Sphere{1e-6});
    EXPECT_TRUE(meet(world, grain.moved({1e6 + 1e-6, 0, 0})));
    EXPECT_FALSE(meet(world, grain.moved({1e6 + 3e-6, 5, 7})));
    EXPECT_NEAR(gap(world, grain.moved({1e6 + 3e-6, 5, 7})), 2e-6, 1e-9);
    const Thing drum(shape::Cylinder{1e6, 1e6}), speck(shape::Ellipsoid{{1e-6, 2e-6, 3e-6}});
    EXPECT_TRUE(meet(drum, speck.moved({6e5, 8e5 - 1, 0})));
    EXPECT_FALSE(meet(drum, speck.moved({6e5, 8e5 + 1e-5, 5e5 + 1e-5})));
    for (const double size : {1e-6, 1e6}) {
        const Thing one(shape::Cone{size, size}), other(shape::Cylinder{size, size});
        EXPECT_NEAR(gap(one, other.moved({3 * size, 0, 0})), size, 1e-9 * size);
        EXPECT_NEAR(contact(one, other.moved({0, 0, -0.75 * size})).depth, 0.25 * size, 1e-9 * size);
    }
}

/// Returns a pose whose numbers are rounded: those of the next two tests were found by certificates in random pairs.
Pose rows(const std::array<std::array<double, 4>, 3>& numbers) {
    Pose pose;
    pose.rows = numbers;
    return pose;
}

/// The search for the distance ends early, because of rounding at the far vertices of the large hull.
TEST(ConvexPair, ATinyHullIsToldApartFromALargeOne) {
    const Thing tiny(shape::ConvexHull{{{0x1.01d1874224ea9p-18, -0x1.a960204d08f8ap-18, -0x1.274fd12470215p-18},
                                        {-0x1.4dc0cefd81fabp-18, 0x1.eea91f74d6466p-18, 0x1.583da1e367fb9p-18},
                                        {-0x1.34c022b5e9066p-20, -0x1.b7cfcf6311069p-19, 0x1.46a3af937eb3cp-20},
                                        {0x1.0c1af372fdd0ep-23, 0x1.b431a60c1bab1p-19, 0x1.2646119fcb83dp-19}}},
                     Point3d{-0x1.408fccc3ef5d4p+0, -0x1.118f6375382bep-4, -0x1.6340fc881b9cfp+1});
    const Thing large(
        shape::ConvexHull{{{-0x1.c0efb23d23b12p-2, -0x1.03f2b8e507f97p-1, -0x1.e096ba76dbfp-3},
                           {0x1.ed43bba1eaef6p-2, 0x1.432051b8f8a28p-1, 0x1.e3189264b995cp-3},
                           {0x1.8dffa70029a41p-1, -0x1.7ff787615c51ap+0, 0x1.9eb49586ca45ep-1},
                           {0x1.6a1b06eabbefp-4, -0x1.b8a726b9585bap+0, -0x1.dceb74998179p+0},
                           {-0x1.9b96c9502d881p-1, -0x1.2a65806123778p-3, 0x1.798181f5aac64p-2},
                           {-0x1.473aaea06f375p+0, -0x1.a6bdaa3be2f52p-1, 0x1.963ceef36180cp-3}}},
        rows({{{0x1.b5fe5ed580c3p-1, 0x1.0133b03da82e6p-1, 0x1.01c4799b5cfe4p-3, -0x1.d4497cb963114p-3},
               {-0x1.c31715a2c78edp-2, 0x1.aad287587c74fp-1, -0x1.5526c2ffec4dep-2, 0x1.92a919295872p-1},
               {-0x1.16d1a1204a9c4p-2, 0x1.d6210d89eefd2p-3, 0x1.de6e0e3c5d449p-1, -0x1.3b149a4cb976dp-1}}}));
    EXPECT_FALSE(meet(tiny, large));
    EXPECT_NEAR(gap(tiny, large), 3.8704e-10, 1e-14);
}

/// The segment of the capsule is 37,000 above the hull: the way between the two nearest points is too inaccurate a direction for the depth.
TEST(ConvexPair, ACapsuleInTheSurfaceOfALargeHull) {
    const Thing capsule(
        shape::Capsule{0x1.3599d718ef7b8p+20, 0x1.d64f3d4a1d71bp+18},
        rows({{{0x1.e792296cf5d7p-1, -0x1.c353118beb772p-3, -0x1.b0705af073af2p-3, 0x1.176a8c71c6e8ep+35},
               {0x1.25df73ae161c4p-2, 0x1.c396a28c420e3p-1, 0x1.7ebc3fc1ec83ep-2, -0x1.5f04dfd37fc77p+34},
               {0x1.a97379d36b408p-4, -0x1.aa8692f64827dp-2, 0x1.ce6c326097ee6p-1, 0x1.d87db93762918p+33}}}));
    const Thing hull(
        shape::ConvexHull{{{-0x1.6b71307d32d46p+33, -0x1.d66d93abad01p+31, 0x1.32845c91b59ecp+33},
                           {0x1.183140860bb9fp+34, -0x1.0ec0f31052892p+36, 0x1.7c81c7d68965cp+35},
                           {-0x1.ebffc19f02558p+32, -0x1.a15f15f4f8ce9p+34, -0x1.e9d21b1cabc9cp+35},
                           {0x1.2670e4109cfd8p+33, 0x1.4b713e35ac7c3p+34, 0x1.59693364dc6a4p+36}}},
        rows({{{0x1.c6d1029208ed1p-2, 0x1.bb0248577fadep-1, -0x1.dc31e67235008p-3, 0x1.756802b308aecp+35},
               {0x1.550b2f1440ac6p-1, -0x1.29a5b732a34fcp-3, 0x1.768fa9f3064bep-1, 0x1.82ec32410549cp+34},
               {0x1.32c9a7dd577a4p-1, -0x1.eb531ca43ab39p-2, -0x1.4823a0d9c75f6p-1, -0x1.03144c53b944fp+35}}}));
    EXPECT_NEAR(contact(capsule, hull).depth, 1231086.04, 0.1);
    EXPECT_NEAR(contact(hull, capsule).depth, 1231086.04, 0.1);
}

TEST(ConvexPair, FarFromTheOrigin) {
    RandomStream random(8, 0);
    for (int kind = 0; kind < kinds; ++kind) {
        // Rounds places to multiples of 2^-30, which float64 still holds exactly far from the origin.
        const auto near = [&](double at) { return std::round(at * 0x1p30) * 0x1p-30; };
        Thing a(random_shape(kind, random), random_pose(random, 1)), b(random_shape(3, random), random_pose(random, 1));
        for (Thing* thing : {&a, &b}) {
            for (auto& row : thing->posed.pose.rows) row[3] = near(row[3]);
        }
        b = b.moved({2.5, 2, 1});
        const Point3d far = {1e6, -1e6, 0.5e6};
        EXPECT_NEAR(gap(a.moved(far), b.moved(far)), gap(a, b), 1e-12);
    }
}

TEST(ConvexPair, HullsMayBeScaledAndMirrored) {
    const shape::ConvexHull corner = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    Pose mirrored, flat;
    mirrored.rows[0][0] = -2;
    flat.rows[2][2] = 0;
    const Thing dot(shape::ConvexHull{{{0, 0, 0}}});
    EXPECT_TRUE(meet(Thing(corner, mirrored), dot.moved({-1.5, 0.25, 0})));
    EXPECT_FALSE(meet(Thing(corner, mirrored), dot.moved({0.5, 0.25, 0})));
    EXPECT_TRUE(meet(Thing(corner, flat), dot.moved({0.25, 0.25, 0})));
    EXPECT_NEAR(gap(Thing(corner, flat), dot.moved({0.25, 0.25, 0.5})), 0.5, 1e-12);
}

TEST(ConvexPair, TrianglesAndPoints) {
    const Thing cylinder(shape::Cylinder{1, 2}, Point3d{1e6, 0, 0});
    std::array<Point3d, 3> triangle = {{{1e6 + 2, -1, 0}, {1e6 + 2, 1, 0}, {1e6 + 2, 0, 1}}};
    EXPECT_NEAR(convex_gap(PosedConvex(triangle), cylinder.convex()).distance, 1, 1e-9);
    EXPECT_FALSE(convex_contains(cylinder.convex(), PosedConvex(triangle)));
    for (Point3d& corner : triangle) corner[0] = 1e6 + 0.25, corner[1] *= 0.5, corner[2] *= 0.5;
    EXPECT_TRUE(convex_meet(PosedConvex(triangle), cylinder.convex()));
    EXPECT_TRUE(convex_contains(cylinder.convex(), PosedConvex(triangle)));
    EXPECT_TRUE(convex_meet(PosedConvex(Point3d{1e6 + 1, 0, 1}), cylinder.convex()));
    EXPECT_FALSE(convex_contains(cylinder.convex(), PosedConvex(Point3d{1e6 + 1, 0, 1})));
    EXPECT_FALSE(convex_meet(PosedConvex(Point3d{1e6 + 1, 0.001, 1}), cylinder.convex()));
}

TEST(ConvexPair, HoldsWhatStaysBelowItsSurface) {
    RandomStream random(9, 0);
    int held = 0;
    for (int kind_a = 0; kind_a < kinds; ++kind_a) {
        for (int kind_b = 0; kind_b < kinds; ++kind_b) {
            for (int i = 0; i < 20; ++i) {
                const Thing outer(random_shape(kind_a, random), random_pose(random, 0.3));
                const Thing inner(random_shape(kind_b, random), random_pose(random, 0.3));
                if (!convex_contains(outer.convex(), inner.convex())) continue;
                ++held;
                // No point of the inner shape is outside of the outer shape.
                for (int k = 0; k < 50; ++k) {
                    const Point3d point = nearest_in(inner.posed, times(random_point(random), 10));
                    EXPECT_LT(outer.off(point), 1e-12) << kind_a << ", " << kind_b;
                }
            }
        }
    }
    EXPECT_GT(held, 30);
    const Thing box(shape::Box{{1, 1, 1}}), ball(shape::Sphere{0.5});
    EXPECT_TRUE(convex_contains(box.convex(), ball.moved({0.499, 0, 0}).convex()));
    EXPECT_FALSE(convex_contains(box.convex(), ball.moved({0.5, 0, 0}).convex()));
}

}  // namespace
}  // namespace octopair::test
