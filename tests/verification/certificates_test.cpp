// Tests the narrow phase by certificates: class, depth, distance and contacts of convex pairs of all kinds, at ratios of size up to a
// million, at scales from 2^-500 to 2^500, in both orders and turned at random.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "octopair/filters.hpp"
#include "octopair/pipeline.hpp"
#include "pipeline/exact_scene.hpp"
#include "samples/random.hpp"
#include "support/cases.hpp"
#include "support/scale.hpp"
#include "verification/shapes/distance_bounds.hpp"
#include "verification/shapes/shape_pair.hpp"

namespace octopair::test {
namespace {

using samples::RandomStream;

constexpr int kinds = 8;

/// Returns a shape of a kind, of about the size `size`.
shape::Any shape_of_kind(int kind, double size, RandomStream& random) {
    const auto length = [&] { return size * random.uniform(0.2, 1); };
    switch (kind) {
        case 0:
            return shape::Sphere{length()};
        case 1:
            return shape::Box{{length(), length(), length()}};
        case 2:
            return shape::Capsule{length(), length()};
        case 3:
            return shape::Cylinder{length(), length()};
        case 4:
            return shape::Cone{length(), length()};
        case 5:
            return shape::Ellipsoid{{length(), length(), length()}};
        case 6: {  // nearly a sphere
            const double radius = length();
            return shape::Ellipsoid{{radius, radius * (1 + 1e-9), radius * (1 - 1e-7)}};
        }
        default:
            break;
    }
    shape::ConvexHull hull;
    for (std::uint64_t i = 1 + random.below(9); i > 0; --i)
        hull.points.push_back({size * random.gaussian(), size * random.gaussian(), size * random.gaussian()});
    return hull;
}

Pose random_pose(const Point3d& place, RandomStream& random) {
    if (random.below(4) == 0) return make_pose(place);
    return make_pose(place, {random.gaussian(), random.gaussian(), random.gaussian(), random.gaussian()});
}

/// Returns a scene of two shapes that are apart, touch nearly, overlap or contain each other.
Scene random_pair(int first, int second, double ratio, double scale, RandomStream& random) {
    Scene scene;
    const double small = scale / ratio;
    shape::Any a = shape_of_kind(first, small, random), b = shape_of_kind(second, scale, random);
    Pose pose = random_pose({0, 0, 0}, random);
    const Pose other =
        random_pose({scale * random.gaussian(), scale * random.gaussian(), scale * random.gaussian()}, random);
    // Moves the first shape to the surface of the second one, and a little beyond or inside, or to its middle.
    const certificate::Vector direction{random.gaussian(), random.gaussian(), random.gaussian()};
    const certificate::ConvexBody body(b, other), mover(a, pose);
    const certificate::Vector to = body.support(direction), from = mover.support(-direction);
    const double depth = random.below(3) == 0 ? 0 : small * random.gaussian();
    const double size = double(certificate::length(direction));
    const certificate::Vector way = to - from - direction * (depth / size);
    const bool within = random.below(4) == 0;
    pose.rows[0][3] += within ? other.rows[0][3] : double(way.x);
    pose.rows[1][3] += within ? other.rows[1][3] : double(way.y);
    pose.rows[2][3] += within ? other.rows[2][3] : double(way.z);
    scene.add(std::move(a), pose);
    scene.add(std::move(b), other);
    if (random.below(2) == 0) {
        std::swap(scene.geometry[0], scene.geometry[1]);
        std::swap(scene.poses[0], scene.poses[1]);
    }
    return scene;
}

/// Returns a margin that differs from the distance of the two objects by about a hundred millionth of the larger one's size, or less.
double margin_near_distance(const Scene& scene, double scale, RandomStream& random) {
    const auto body = [&](std::size_t i) {
        return certificate::ConvexBody(scene.geometries[scene.geometry[i]].shape(), scene.poses[i]);
    };
    const certificate::Real distance = certificate::bound_distance(body(0), body(1), 0, scale * 1e6L).upper;
    return std::max(0.0, double(distance) + scale * random.gaussian() * std::pow(10, random.uniform(-16, -8)));
}

class Certificates : public ::testing::TestWithParam<int> {};

TEST_P(Certificates, AgreeWithTheNarrowPhase) {
    const std::uint64_t pairs = case_count(scaled(160, 10));
    std::array<int, collision_classes> found = {};
    int dropped = 0;
    for (std::uint64_t i = 0; i < pairs; ++i) {
        for (int second = 0; second < kinds; ++second) {
            const std::uint64_t seed = case_seed("certificates", i);
            SCOPED_TRACE("kinds " + std::to_string(GetParam()) + " and " + std::to_string(second) +
                         ", OCTOPAIR_TEST_SEED=" + std::to_string(seed));
            RandomStream random(seed, std::uint64_t(GetParam() * kinds + second));
            const double ratio = random.below(2) == 0 ? 1 : std::pow(10, random.uniform(0, 6));
            const double scale = random.below(2) == 0 ? 1 : std::ldexp(1, int(random.below(1001)) - 500);
            const Scene scene = random_pair(GetParam(), second, ratio, scale, random);
            ExactOptions options;
            const std::uint64_t kind_of_margin = random.below(3);
            if (kind_of_margin == 1) options.margin = scale / ratio * random.uniform();
            if (kind_of_margin == 2) options.margin = margin_near_distance(scene, scale, random);
            const std::vector<Collision> collisions = find(scene, options, 1);
            const Finding* const finding = collisions.empty() ? nullptr : &collisions[0].finding;
            const auto object = [&](std::size_t k) {
                return JudgedObject{scene.geometries[scene.geometry[k]], scene.poses[k]};
            };
            const StageRules rules{.margin = options.margin, .features = true};
            const PairVerdict verdict = judge_pair({object(0), object(1)}, rules, finding);
            ASSERT_EQ(verdict.fault, "") << "ratio " << ratio << ", scale " << scale;
            const bool is_duplicate = finding != nullptr && finding->collision_class == CollisionClass::duplicate;
            EXPECT_EQ(verdict.not_checked != nullptr, is_duplicate);
            finding == nullptr ? ++dropped : ++found[std::size_t(finding->collision_class)];
        }
    }
    if (pairs < 20) return;
    EXPECT_GT(dropped, 0);
    EXPECT_GT(found[std::size_t(CollisionClass::clearance)], 0);
    EXPECT_GT(found[std::size_t(CollisionClass::penetrating)], 0);
    EXPECT_GT(found[std::size_t(CollisionClass::contained)], 0);
}

/// A depth without bounds would contradict nothing. Bounds for two balls around one place converge slowly. Symmetric bodies are the hard ones: all points that a search finds may be in a plane.
TEST_P(Certificates, BoundTheDepthOfAllKinds) {
    for (int second = 0; second < kinds; ++second) {
        for (const Point3d place : {Point3d{0.1, 0, 0}, Point3d{0, 0, -0.1}, Point3d{0.05, 0.06, -0.07}, Point3d{}}) {
            RandomStream random(7, std::uint64_t(GetParam() * kinds + second));
            const auto solid = [&](int kind) {
                shape::Any shape = shape_of_kind(kind, 1, random);
                if (auto* const hull = std::get_if<shape::ConvexHull>(&shape))
                    hull->points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
                return shape;
            };
            const shape::Any shape = solid(GetParam()), other = solid(second);
            const certificate::ConvexBody a(shape, make_pose({0, 0, 0})), b(other, make_pose(place));
            const certificate::DepthBounds depth = certificate::bound_depth(a, b, 1e-6L, 1e6L);
            EXPECT_GT(depth.lower, 0.1L) << "kinds " << GetParam() << " and " << second;
            EXPECT_NEAR(double(depth.upper), double(depth.lower), 0.03) << "kinds " << GetParam() << " and " << second;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Certificates, ::testing::Range(0, kinds));

}  // namespace
}  // namespace octopair::test
