// Tests convex shapes of every scale, and pairs of shapes of very unlike sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

#include "narrow_phase/convex_things.hpp"
#include "samples/meshes.hpp"

namespace octopair::test {
namespace {

using samples::random_pose;
using samples::RandomStream;
using vector::length;
using vector::minus;
using vector::plus;
using vector::times;

/// Multiplies all lengths of a shape by a power of two.
shape::Any scaled_shape(shape::Any shape, int exponent) {
    const auto scale = [exponent](double& length) { length = std::ldexp(length, exponent); };
    if (auto* sphere = std::get_if<shape::Sphere>(&shape)) scale(sphere->radius);
    if (auto* box = std::get_if<shape::Box>(&shape))
        std::for_each(box->half_extents.begin(), box->half_extents.end(), scale);
    if (auto* capsule = std::get_if<shape::Capsule>(&shape)) scale(capsule->radius), scale(capsule->length);
    if (auto* cylinder = std::get_if<shape::Cylinder>(&shape)) scale(cylinder->radius), scale(cylinder->length);
    if (auto* cone = std::get_if<shape::Cone>(&shape)) scale(cone->radius), scale(cone->length);
    if (auto* ellipsoid = std::get_if<shape::Ellipsoid>(&shape))
        std::for_each(ellipsoid->radii.begin(), ellipsoid->radii.end(), scale);
    if (auto* hull = std::get_if<shape::ConvexHull>(&shape)) {
        for (Point3d& point : hull->points) std::for_each(point.begin(), point.end(), scale);
    }
    return shape;
}

Thing scaled_thing(const Thing& thing, int exponent) {
    Pose pose = thing.posed.pose;
    for (auto& row : pose.rows) row[3] = std::ldexp(row[3], exponent);
    return {scaled_shape(thing.posed.shape, exponent), pose};
}

TEST(ConvexScale, EveryScaleGivesTheSameAnswers) {
    RandomStream random(12, 0);
    for (int kind_a = 0; kind_a < kinds; ++kind_a) {
        for (int kind_b = 0; kind_b < kinds; ++kind_b) {
            const Thing a(random_shape(kind_a, random), random_pose(random, 1)),
                b(random_shape(kind_b, random), random_pose(random, 1));
            const Thing within(scaled_shape(a.posed.shape, -4), a.posed.pose);
            for (const int exponent : {-900, -500, -274, -199, 199, 257, 500, 900}) {
                SCOPED_TRACE("kinds " + std::to_string(kind_a) + ", " + std::to_string(kind_b) + ", scale 2^" +
                             std::to_string(exponent));
                const Thing big_a = scaled_thing(a, exponent), big_b = scaled_thing(b, exponent);
                const ConvexGap apart = convex_gap(a.convex(), b.convex()),
                                found = convex_gap(big_a.convex(), big_b.convex());
                EXPECT_EQ(found.distance, std::ldexp(apart.distance, exponent));
                EXPECT_EQ(found.at_least, std::ldexp(apart.at_least, exponent));
                EXPECT_EQ(found.on_a[0], std::ldexp(apart.on_a[0], exponent));
                EXPECT_EQ(contact(big_a, big_b).depth, std::ldexp(contact(a, b).depth, exponent));
                EXPECT_EQ(contact(big_a, big_b).point[1], std::ldexp(contact(a, b).point[1], exponent));
                EXPECT_EQ(meet(big_a, big_b), meet(a, b));
                EXPECT_EQ(convex_within(big_a.convex(), big_b.convex(), std::ldexp(0.25, exponent)),
                          convex_within(a.convex(), b.convex(), 0.25));
                EXPECT_EQ(convex_contains(big_a.convex(), scaled_thing(within, exponent).convex()),
                          convex_contains(a.convex(), within.convex()));
            }
        }
    }
}

TEST(ConvexScale, SizesDownToTheLeastNumbers) {
    for (const double size : {1e-300, 1e-307, 1e-308, 1e-309, 1e-320}) {
        const shape::Any shapes[] = {
            shape::Sphere{size},         shape::Box{{size, size, size}},       shape::Capsule{size, size},
            shape::Cylinder{size, size}, shape::Ellipsoid{{size, size, size}}, shape::Cone{size, size}};
        for (const auto& shape_a : shapes) {
            for (const auto& shape_b : shapes) {
                const Thing a(shape_a), b(shape_b, Point3d{size / 2, 0, 0});
                EXPECT_TRUE(meet(a, b)) << size;
                EXPECT_LE(contact(a, b).depth, 4 * size);
                // Below 1e-308, numbers have fewer digits than the proof of a gap needs.
                EXPECT_FALSE(size >= 1e-308 && meet(a, b.moved({10 * size, 0, 0}))) << size;
            }
        }
    }
}

/// Returns a hull of random points, and a random point inside of it.
std::pair<shape::ConvexHull, Point3d> hull_and_point(std::uint64_t count, double size, RandomStream& random) {
    shape::ConvexHull hull;
    Point3d sum = {};
    double weights = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const Point3d way = random_point(random);
        hull.points.push_back(times(way, size / length(way)));
        const double weight = random.uniform(0, 1);
        sum = plus(sum, times(hull.points.back(), weight));
        weights += weight;
    }
    return {hull, times(sum, 1 / weights)};
}

TEST(ConvexScale, ContactsOfTinyThingsAreInBoth) {
    RandomStream random(13, 0);
    for (int i = 0; i < 3000; ++i) {
        const double size = std::pow(10, -random.uniform(0, 6));
        const auto [small, in_small] = hull_and_point(4 + random.below(17), size, random);
        const auto [large, in_large] = hull_and_point(3 + random.below(6), 0.5, random);
        const Thing a(small, minus(in_large, in_small)), b(large);
        const Point3d point = contact(a, b).point;
        ASSERT_LT(std::max(a.off(point), b.off(point)), 1e-9 * size) << i << ", " << size;
    }
}

}  // namespace
}  // namespace octopair::test
