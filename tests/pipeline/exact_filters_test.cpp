// Tests exact filters for objects. The pipeline finds the same collisions as a test of all pairs of objects. Also tests
// cases that other libraries are known to get wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "narrow_phase/motion/motion.hpp"
#include "octopair/error.hpp"
#include "pipeline/exact_scene.hpp"
#include "samples/random.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

using samples::random_pose;
using samples::RandomStream;

TEST(ExactFilters, PlaceErrorsInTheirSet) {
    Scene right, wrong;
    for (Scene* const scene : {&right, &wrong}) {
        scene->add(shape::Sphere{1});
        scene->add(shape::Sphere{1});
    }
    wrong.poses[1].rows[0][3] = std::numeric_limits<double>::quiet_NaN();
    const ShapedObjects good = right.objects(), bad = wrong.objects();
    const auto expect = [&](const auto& make) {
        expect_place([&] { (void)make(bad, nullptr); }, 1, 0);
        expect_place([&] { (void)make(bad, &good); }, 1, 0);
        expect_place([&] { (void)make(good, &bad); }, 1, 1);
    };
    expect([](const ShapedObjects& a, const ShapedObjects* b) { return make_exact_object_filter(a, {}, b); });
    expect([](const ShapedObjects& a, const ShapedObjects* b) { return make_exact_feature_filter(a, {}, b); });
    expect([](const ShapedObjects& a, const ShapedObjects* b) { return make_sphere_filter(a, 0, b); });
    expect([](const ShapedObjects& a, const ShapedObjects* b) { return make_oriented_box_filter(a, 0, b); });
}

std::vector<Pair> pairs_of(const std::vector<Collision>& collisions) {
    std::vector<Pair> pairs;
    pairs.reserve(collisions.size());
    for (const Collision& collision : collisions) pairs.push_back(collision.pair);
    return pairs;
}

std::vector<Pair> all_that_count(const Scene& scene, double margin) {
    std::vector<Pair> pairs;
    for (std::uint32_t a = 0; a < scene.poses.size(); ++a) {
        for (std::uint32_t b = a + 1; b < scene.poses.size(); ++b) {
            const double paddings = scene.padding.empty() ? 0 : scene.padding[a] + scene.padding[b];
            Finding finding;
            if (judge_objects(scene.object(a), scene.object(b), margin + paddings, finding)) pairs.push_back({a, b});
        }
    }
    return pairs;
}

std::vector<shape::Any> every_shape() {
    return {shape::Sphere{0.6},
            shape::Box{{0.5, 0.3, 0.7}},
            shape::Capsule{0.3, 1},
            shape::Cylinder{0.4, 1},
            shape::Cone{0.5, 1},
            shape::Ellipsoid{{0.3, 0.5, 0.8}},
            shape::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.4, 0.4, 0.4}}},
            samples::torus_mesh({12, 8, 0.2, 5}),
            box_mesh({-0.4, -0.4, -0.4}, {0.4, 0.4, 0.4}),
            shape::Mesh{}};
}

Scene mixed_scene(std::uint64_t seed, std::uint32_t objects) {
    Scene scene;
    RandomStream random(seed, 0);
    for (const shape::Any& shape : every_shape()) scene.geometries.emplace_back(shape);
    scene.geometries.emplace_back(shape::Plane{{0.3, 1, 0.1}, 1});
    for (std::uint32_t i = 0; i < objects; ++i) {
        const auto shape = std::uint32_t(i + 1 < objects ? random.below(every_shape().size()) : every_shape().size());
        scene.geometry.push_back(shape);
        scene.poses.push_back(random_pose(random, 6));
    }
    return scene;
}

TEST(ExactFilters, FindWhatTestingAllPairsFinds) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        Scene scene = mixed_scene(seed, 70);
        for (const double margin : {0.0, 0.25}) {
            const std::vector<Pair> all = all_that_count(scene, margin);
            EXPECT_GT(all.size(), 10u);
            EXPECT_EQ(pairs_of(find(scene, {margin})), all) << seed;
        }
        RandomStream random(seed, 1);
        for (std::size_t i = 0; i < scene.poses.size(); ++i) scene.padding.push_back(random.uniform(0, 0.3));
        EXPECT_EQ(pairs_of(find(scene, {0.1})), all_that_count(scene, 0.1)) << seed;
    }
}

TEST(ExactFilters, SameFindingsOnAnyNumberOfThreads) {
    const Scene scene = mixed_scene(4, 100);
    const std::vector<Collision> expected = find(scene, {0.1}, 1);
    for (const unsigned threads : {2u, 5u}) {
        const std::vector<Collision> found = find(scene, {0.1}, threads);
        ASSERT_EQ(pairs_of(found), pairs_of(expected));
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].finding.collision_class, expected[i].finding.collision_class);
            EXPECT_EQ(found[i].finding.distance, expected[i].finding.distance);
            EXPECT_EQ(found[i].finding.depth, expected[i].finding.depth);
            EXPECT_EQ(found[i].finding.contacts.size(), expected[i].finding.contacts.size());
        }
    }
}

TEST(ExactFilters, DistancesAreThoseOfTheNearestPoints) {
    const Scene scene = mixed_scene(5, 60);
    unsigned apart = 0;
    for (const auto& [pair, finding] : find(scene, {0.5})) {
        if (finding.collision_class != CollisionClass::clearance) continue;
        ++apart;
        const auto& [p, q] = finding.nearest;
        EXPECT_NEAR(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), finding.distance, 1e-9);
        EXPECT_LE(finding.distance, 0.5 * (1 + 1e-9));
        EXPECT_GT(finding.distance, 0);
    }
    EXPECT_GT(apart, 20u);
}

TEST(ExactFilters, MeshInMesh) {
    const Finding inside = collision_of(two_boxes({10, 10, 10}, {1, 1, 1}, {2, 3, 4}));
    EXPECT_EQ(inside.collision_class, CollisionClass::contained);
    EXPECT_EQ(inside.depth, 3);  // depth of the corner at (3, 4, 5)
    EXPECT_TRUE(inside.contacts.empty());
}

/// A box with a hole has no inside. What may be in it is left out, but not silently.
TEST(ExactFilters, WhatMayBeInAnOpenMeshIsUndecided) {
    const auto undecided = [](shape::Any outer, shape::Any inner, const Pose& pose) {
        Scene scene;
        scene.add(std::move(outer), pose);
        scene.add(std::move(inner), pose);
        const ShapedObjects objects = scene.objects();
        const std::vector<Box3d> boxes = boxes_of(objects);
        Pipeline pipeline(1);
        pipeline.add(make_exact_object_filter(objects));
        const PipelineSummary summary = pipeline.run(*make_local_engine(1), {std::span(boxes)}, {});
        return std::pair(summary.collisions, summary.filters[0].undecided);
    };
    using Counts = std::pair<std::uint64_t, std::uint64_t>;  // collisions, undecided pairs
    const shape::Mesh closed = box_mesh({0, 0, 0}, {4, 4, 8}), small = box_mesh({1, 1, 1}, {2, 2, 2});
    shape::Mesh open = closed;
    open.triangles.pop_back();
    RandomStream random(5, 0);
    for (int round = 0; round < 20; ++round) {
        Pose pose = random_pose(random, 6);
        for (auto& row : pose.rows) row[1] *= 3;  // not rigid
        EXPECT_EQ(undecided(closed, small, pose), Counts(1, 0));
        EXPECT_EQ(undecided(open, small, pose), Counts(0, 1));
        EXPECT_EQ(undecided(small, open, pose), Counts(0, 1));
        EXPECT_EQ(undecided(small, box_mesh({2.5, 1, 1}, {3, 2, 2}), pose), Counts(0, 0));
        const shape::Mesh beside = box_mesh({4.5, 1, 1}, {5, 2, 2});  // in the world, the boxes of both may overlap
        EXPECT_EQ(undecided(open, beside, pose), Counts(0, 0));
    }
    EXPECT_EQ(undecided(open, shape::Sphere{0.5}, make_pose({0, 0, 0})), Counts(1, 0));
    Pose elsewhere;
    EXPECT_EQ(undecided(open, shape::Mesh{}, elsewhere), Counts(0, 0));
}

TEST(ExactFilters, MeshesOnTopOfEachOther) {
    const Finding same = collision_of(two_boxes({1, 2, 3}, {1, 2, 3}, {0, 0, 0}));
    EXPECT_EQ(same.collision_class, CollisionClass::duplicate);
    // Not the same corners: the space between two coordinates is no place for a third.
    const Finding near = collision_of(two_boxes({1, 2, 3}, {1, 2, 3}, {std::nextafter(0.0, 1.0), 0x1p-52, 0}));
    EXPECT_EQ(near.collision_class, CollisionClass::penetrating);
    EXPECT_FALSE(near.contacts.empty());
}

TEST(ExactFilters, FacesInOnePlane) {
    // The boxes share a whole face, a part of a face, an edge, or a corner.
    for (const Point3d& place : {Point3d{1, 0, 0}, Point3d{1, 0.5, 0.25}, Point3d{1, 1, 0}, Point3d{1, 1, 1}}) {
        const Finding touch = collision_of(two_boxes({1, 1, 1}, {1, 1, 1}, place));
        EXPECT_EQ(touch.collision_class, CollisionClass::touching);
        EXPECT_EQ(touch.depth, 0);
    }
    EXPECT_TRUE(find(two_boxes({1, 1, 1}, {1, 1, 1}, {std::nextafter(1.0, 2.0), 0, 0})).empty());
}

TEST(ExactFilters, OneMeshTwice) {
    EXPECT_EQ(collision_of(two_boxes({2, 3, 4}, {2, 3, 4}, {0, 0, 0})).collision_class, CollisionClass::duplicate);
    const Finding longer = collision_of(two_boxes({2, 3, 4}, {2, 3, 5}, {0, 0, 0}));
    EXPECT_EQ(longer.collision_class, CollisionClass::penetrating);
    EXPECT_EQ(longer.depth, 2);  // no corner is inside
    EXPECT_EQ(longer.depth_kind, DepthKind::least);
}

TEST(ExactFilters, CoaxialWallsThatOverlap) {
    // Two collinear walls with equal cross-sections overlap by 50 mm. No triangle passes through another.
    const Finding walls = collision_of(two_boxes({4, 0.2, 2.5}, {4, 0.2, 2.5}, {3.95, 0, 0}));
    EXPECT_EQ(walls.collision_class, CollisionClass::penetrating);
    EXPECT_NEAR(walls.depth, 0.05, 1e-12);
}

TEST(ExactFilters, MirroredAndScaledMeshes) {
    Scene scene = two_boxes({1, 1, 1}, {1, 1, 1}, {0, 0, 0});
    scene.poses[1].rows = {{{-2, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};  // x from -2 to 0
    EXPECT_EQ(collision_of(scene).collision_class, CollisionClass::touching);
    scene.poses[1].rows[0][3] = 0.125;
    EXPECT_EQ(collision_of(scene).collision_class, CollisionClass::penetrating);
    scene.poses[1].rows[0][3] = -0.125;
    EXPECT_TRUE(find(scene).empty());
    scene.poses[1].rows = {{{-0.5, 0, 0, 0.75}, {0, 0.5, 0, 0.25}, {0, 0, 0.5, 0.25}}};
    EXPECT_EQ(collision_of(scene).collision_class, CollisionClass::contained);
}

TEST(ExactFilters, FarFromTheOrigin) {
    for (const double far : {1e6, 1e9}) {
        Scene scene = two_boxes({4, 0.25, 2.5}, {4, 0.25, 2.5}, {3.9375, 0, 0});
        for (Pose& pose : scene.poses) {
            for (auto& row : pose.rows) row[3] += far;
        }
        const Finding walls = collision_of(scene);
        EXPECT_EQ(walls.collision_class, CollisionClass::penetrating);
        EXPECT_EQ(walls.depth, 0.0625);
        scene.poses[1].rows[0][3] += 0.0625;
        EXPECT_EQ(collision_of(scene).collision_class, CollisionClass::touching);
        scene.poses[1].rows[0][3] += 0.0625;
        EXPECT_TRUE(find(scene).empty());
        EXPECT_EQ(collision_of(scene, {0.0625}).distance, 0.0625);
    }
}

TEST(ExactFilters, EmptyAndDegenerateMeshes) {
    Scene scene;
    scene.add(box_mesh({0, 0, 0}, {1, 1, 1}));
    scene.add(shape::Mesh{});
    scene.add(shape::Mesh{{{0.5, 0.5, 0.5}}, {}});           // a vertex without a triangle
    scene.add(shape::Mesh{{{0.5, 0.5, 0.5}}, {{0, 0, 0}}});  // a triangle that is a point
    scene.add(shape::Mesh{{{0.5, 0.5, 0.5}, {2, 0.5, 0.5}}, {{0, 1, 0}}});
    EXPECT_EQ(pairs_of(find(scene)), (std::vector<Pair>{{0, 3}, {0, 4}, {3, 4}}));
}

TEST(ExactFilters, SolidsInSolids) {
    const auto class_of = [](shape::Any a, shape::Any b, const Point3d& place) {
        Scene scene;
        scene.add(std::move(a));
        scene.add(std::move(b), make_pose(place));
        return collision_of(scene).collision_class;
    };
    const shape::Mesh cube = box_mesh({-1, -1, -1}, {1, 1, 1});
    EXPECT_EQ(class_of(shape::Sphere{2}, shape::Sphere{0.5}, {1, 0, 0}), CollisionClass::contained);
    EXPECT_EQ(class_of(shape::Sphere{2}, shape::Sphere{0.5}, {1.75, 0, 0}), CollisionClass::penetrating);
    EXPECT_EQ(class_of(shape::Sphere{2}, shape::Sphere{0.5}, {2.5, 0, 0}), CollisionClass::touching);
    EXPECT_EQ(class_of(cube, shape::Sphere{0.5}, {0.25, 0, 0}), CollisionClass::contained);
    EXPECT_EQ(class_of(cube, shape::Sphere{0.5}, {1, 0, 0}), CollisionClass::penetrating);
    EXPECT_EQ(class_of(cube, shape::Sphere{0.5}, {1.5, 0, 0}), CollisionClass::touching);
    EXPECT_EQ(class_of(cube, shape::Sphere{5}, {0, 0, 0}), CollisionClass::contained);
    EXPECT_EQ(class_of(shape::Sphere{5}, cube, {0, 0, 0}), CollisionClass::contained);
    EXPECT_EQ(class_of(shape::Box{{1, 1, 1}}, cube, {0, 0, 2}), CollisionClass::touching);
    EXPECT_EQ(class_of(shape::Plane{{0, 0, 2}, 2}, cube, {0, 0, 0}), CollisionClass::touching);
    EXPECT_EQ(class_of(cube, shape::Plane{{0, 0, 1}, 0.5}, {0, 0, 0}), CollisionClass::penetrating);
}

TEST(ExactFilters, SolidsInMeshesWithWallsInOnePlane) {
    const auto finding_of = [](shape::Any a, shape::Any b, const Point3d& place) {
        Scene scene;
        scene.add(std::move(a));
        scene.add(std::move(b), make_pose(place));
        return collision_of(scene);
    };
    const shape::Mesh cube = box_mesh({-4, -4, -4}, {4, 4, 4});
    for (const shape::Any& solid : {shape::Any(shape::Box{{4, 4, 4}}), shape::Any(shape::Sphere{4}),
                                    shape::Any(shape::Box{{4, 1, 1}}), shape::Any(shape::Cylinder{1, 8})}) {
        EXPECT_EQ(finding_of(cube, solid, {0, 0, 0}).collision_class, CollisionClass::penetrating);
        EXPECT_GT(finding_of(cube, solid, {0, 0, 0}).depth, 0.5);
    }
    EXPECT_EQ(finding_of(cube, shape::Box{{1, 1, 1}}, {3, 0, 0}).depth, 2);  // flush with a wall
    EXPECT_EQ(finding_of(cube, shape::Sphere{1}, {3, 0, 0}).depth, 2);
    EXPECT_EQ(finding_of(cube, shape::Box{{1, 1, 1}}, {5, 0, 0}).collision_class, CollisionClass::touching);
    EXPECT_EQ(finding_of(cube, shape::Box{{1, 1, 1}}, {5, 0, 0}).depth, 0);
    EXPECT_EQ(finding_of(cube, shape::Sphere{1}, {0, 0, 0}).depth, 5);  // contained: distance to leave through a wall
}

TEST(ExactFilters, ContactsLeadOutOfClosedMeshes) {
    for (const double height : {-0.1, 0.1, 0.2}) {  // height of the ball's centre above the lower wall
        Scene scene;
        scene.add(box_mesh({-1, -1, 0}, {1, 1, 2}));
        scene.add(shape::Sphere{0.25}, make_pose({0.25, 0.125, height}));
        const Finding finding = collision_of(scene);
        EXPECT_NEAR(finding.depth, height + 0.25, 1e-6);
        ASSERT_FALSE(finding.contacts.empty());
        EXPECT_NEAR(finding.contacts[0].normal[2], -1, 1e-6);
        EXPECT_NEAR(finding.contacts[0].depth, height + 0.25, 1e-6);
    }
}

TEST(ExactFilters, NormalsPointFromFirstToSecond) {
    for (const bool mesh_first : {false, true}) {
        Scene scene;
        const shape::Mesh cube = box_mesh({-1, -1, -1}, {1, 1, 1});
        if (mesh_first) scene.add(cube);
        scene.add(shape::Sphere{0.5}, make_pose({0, 0, 1.375}));
        if (!mesh_first) scene.add(cube);
        const Finding finding = collision_of(scene);
        ASSERT_FALSE(finding.contacts.empty());
        EXPECT_NEAR(finding.contacts[0].normal[2], mesh_first ? 1 : -1, 1e-6);
        EXPECT_NEAR(finding.contacts[0].depth, 0.125, 1e-6);
        const Contact& contact = finding.contacts[0];
        EXPECT_NE(mesh_first ? contact.feature_a : contact.feature_b, Contact::no_feature);
        EXPECT_EQ(mesh_first ? contact.feature_b : contact.feature_a, Contact::no_feature);
    }
}

TEST(ExactFilters, ContactsAreCutByTheLimitAndSaySo) {
    Scene scene;
    scene.add(samples::sphere_mesh(1, 3));
    scene.add(samples::sphere_mesh(1, 3), make_pose({0.5, 0.25, 0.125}));
    const Finding all = collision_of(scene, {0, 100'000});
    ASSERT_GT(all.contacts.size(), 50u);
    EXPECT_FALSE(all.more_contacts);
    for (const Contact& contact : all.contacts) {
        // The contact is inside both spheres.
        EXPECT_LE(std::hypot(contact.point[0], contact.point[1], contact.point[2]), 1 + 1e-9);
        EXPECT_LE(std::hypot(contact.point[0] - 0.5, contact.point[1] - 0.25, contact.point[2] - 0.125), 1 + 1e-9);
    }
    const Finding some = collision_of(scene, {0, 10});
    EXPECT_TRUE(some.more_contacts);
    ASSERT_EQ(some.contacts.size(), 10u);
    for (std::size_t i = 0; i < 10; ++i) {
        EXPECT_EQ(some.contacts[i].feature_a, all.contacts[i].feature_a);
        EXPECT_EQ(some.contacts[i].depth, all.contacts[i].depth);
    }
    EXPECT_EQ(some.depth, all.depth);
}

TEST(MovingObjects, FastOnesDoNotPassThroughThinOnes) {
    Scene scene;
    scene.add(box_mesh({0, -5, -5}, {0.001, 5, 5}));
    scene.add(shape::Sphere{0.01}, make_pose({-100, 0, 0}));
    scene.end_poses = {Pose{}, make_pose({300, 0, 0})};
    const Finding hit = collision_of(scene);
    EXPECT_NEAR(hit.time, (100 - 0.01) / 400, 1e-9);
    EXPECT_EQ(hit.collision_class, CollisionClass::touching);
    ASSERT_EQ(hit.contacts.size(), 1u);
    EXPECT_NEAR(hit.contacts[0].normal[0], -1, 1e-6);  // points from the wall to the ball
    scene.end_poses[1] = make_pose({-0.02, 0, 0});
    EXPECT_TRUE(find(scene).empty());
    const Finding near = collision_of(scene, {0.02});
    EXPECT_EQ(near.collision_class, CollisionClass::clearance);
    EXPECT_NEAR(near.distance, 0.02, 1e-6);
}

TEST(MovingObjects, BladesTurnIntoWhatTheyReach) {
    for (const bool mesh : {false, true}) {
        Scene scene;
        if (mesh) {
            scene.add(box_mesh({-2, -0.1, -0.1}, {2, 0.1, 0.1}));
        } else {
            scene.add(shape::Box{{2, 0.1, 0.1}});
        }
        scene.add(shape::Sphere{0.25}, make_pose({0, 1.5, 0}));
        scene.end_poses = {make_pose({0, 0, 0}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}), scene.poses[1]};
        // The blade touches the ball when the ball's centre is 0.35 from the blade's axis: 0.1 (half the blade's
        // thickness) + 0.25 (the ball's radius).
        const double angle = std::acos(-1.0) / 2 - std::asin(0.35 / 1.5);
        EXPECT_NEAR(collision_of(scene).time, angle / (std::acos(-1.0) / 2), 1e-5);
        scene.end_poses[0] = make_pose({0, 0, 0}, {std::cos(0.5), 0, 0, std::sin(0.5)});
        EXPECT_TRUE(find(scene).empty());
    }
}

TEST(MovingObjects, LongWaysBesideEachOtherAreNoImpact) {
    const shape::Mesh valley = {{{-2000, -2000, 0}, {2000, -2000, 0}, {2000, 2000, 0}, {-2000, 2000, 0}, {0, 3000, 50}},
                                {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}}};
    Scene scene;
    scene.add(shape::Sphere{1}, make_pose({-1000, 0, 1.5}));
    scene.add(valley);
    scene.end_poses = {make_pose({1000, 0, 1.5}), Pose{}};
    EXPECT_TRUE(find(scene).empty());
    EXPECT_TRUE(find(scene, {0.49}).empty());
    EXPECT_EQ(find(scene, {0.51}).size(), 1u);

    // These paths are parallel to a plane and to a rail, both turned by 45 degrees.
    Scene plane;
    plane.add(shape::Sphere{1}, make_pose({-1000, 1000, 0}));
    plane.add(shape::Plane{{1, 1, 0}, -1.3 * std::sqrt(2.0)});
    plane.end_poses = {make_pose({1000, -1000, 0}), Pose{}};
    EXPECT_TRUE(find(plane).empty());
    const std::array<double, 4> turn = {std::cos(std::acos(-1.0) / 8), 0, 0, std::sin(std::acos(-1.0) / 8)};
    Scene rail;
    rail.add(shape::Box{{1, 1, 1}}, make_pose({-70, -70, 0}, turn));
    rail.add(shape::Box{{100, 1, 1}}, make_pose({-1.43, 1.43, 0}, turn));
    rail.end_poses = {make_pose({70, 70, 0}, turn), rail.poses[1]};
    EXPECT_TRUE(find(rail).empty());
    const Finding beside = collision_of(rail, {0.03});
    EXPECT_EQ(beside.collision_class, CollisionClass::clearance);
    EXPECT_NEAR(beside.distance, 1.43 * std::sqrt(2.0) - 2, 1e-6);
    EXPECT_LE(beside.distance, 0.03);

    Scene descent;
    descent.add(shape::Sphere{1}, make_pose({0, 0, 2}));
    descent.add(shape::Plane{{0, 0, 1}, 0});
    descent.end_poses = {make_pose({10'000, 0, 0}), Pose{}};
    EXPECT_NEAR(collision_of(descent).time, 0.5, 1e-5);
}

TEST(MovingObjects, NoMomentIsMissed) {
    Scene scene = mixed_scene(6, 40);
    RandomStream random(6, 2);
    for (std::size_t i = 0; i < scene.poses.size(); ++i) {
        Pose end = random_pose(random, 6);
        if (i + 1 == scene.poses.size()) end = scene.poses[i];
        scene.end_poses.push_back(end);
    }
    const std::vector<Collision> collisions = find(scene);
    std::vector<Pair> at_moments;
    Scene frozen = scene;
    frozen.end_poses.clear();
    for (int step = 0; step <= 64; ++step) {
        for (std::size_t i = 0; i < scene.poses.size(); ++i) {
            frozen.poses[i] = Motion::between(scene.poses[i], scene.end_poses[i])->at(step / 64.0);
        }
        for (const Pair& pair : all_that_count(frozen, 0)) {
            const auto found = std::find_if(collisions.begin(), collisions.end(),
                                            [&](const Collision& collision) { return collision.pair == pair; });
            ASSERT_NE(found, collisions.end()) << pair.a << " and " << pair.b << " at " << step / 64.0;
            EXPECT_LE(found->finding.time, step / 64.0);
            at_moments.push_back(pair);
        }
    }
    EXPECT_GT(at_moments.size(), 1000u);
}

TEST(ExactFilters, BadOptionsAndObjectsAreRefused) {
    Scene scene = two_boxes({1, 1, 1}, {1, 1, 1}, {0, 0, 0});
    EXPECT_THROW(find(scene, {-1}), Error);
    EXPECT_THROW(find(scene, {std::numeric_limits<double>::quiet_NaN()}), Error);
    scene.poses[1].rows[1][2] = std::numeric_limits<double>::infinity();
    EXPECT_THROW(find(scene), Error);
}

}  // namespace
}  // namespace octopair::test
