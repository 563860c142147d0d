// Tests the check of collisions: right ones pass, and each planted error is found and names its pair.
#include "verification/shapes/stage_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "octopair/error.hpp"
#include "pipeline/exact_scene.hpp"
#include "samples/meshes.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

class Stages : public ::testing::Test {
protected:
    Stages() {
        scene_.add(box_mesh({0, 0, 0}, {4, 4, 4}));
        scene_.add(box_mesh({0, 0, 0}, {1, 1, 1}), make_pose({1, 1, 1}));    // in 0
        scene_.add(box_mesh({0, 0, 0}, {1, 1, 1}), make_pose({3.5, 1, 1}));  // crosses 0
        scene_.add(shape::Sphere{0.5}, make_pose({4.7, 2, 2}));              // near 0 and 2
        scene_.add(shape::Sphere{0.25}, make_pose({1.5, 1.5, 1.5}));         // in 0 and 1
        scene_.add(shape::Capsule{0.5, 1}, make_pose({10, 0, 0}));           // meets 6
        scene_.add(shape::Cone{0.5, 1}, make_pose({10.5, 0.1, 0}));          // meets 5
        scene_.add(shape::Cylinder{3, 3}, make_pose({20, 0, 0}));
        scene_.add(shape::Ellipsoid{{0.1, 0.2, 0.3}}, make_pose({20, 0, 0.5}));  // in 7
        scene_.add(shape::Plane{{0, 0, 1}, 1.4});                                // crosses most
        scene_.add(shape::Sphere{1}, make_pose({30, 0, 10}));
        scene_.add(shape::Sphere{1}, make_pose({31.7, 1.7, 10}));  // apart from 10, but their boxes meet
        options_.margin = 0.25;
        collisions_ = find(scene_, options_);
    }

    /// Checks the collisions. Returns the message of the error, empty if there is none.
    std::string complaint(const std::vector<Collision>& collisions) {
        const ShapedObjects objects = scene_.objects();
        const std::vector<Box3d> boxes = boxes_of(objects);
        const Objects all{std::span(boxes), scene_.padding};
        StageCheck check({.boxes = {all, nullptr, options_.margin},
                          .first = objects,
                          .rules = {.margin = options_.margin, .features = true, .min_depth = min_depth_},
                          .threads = 2});
        for (const Collision& one : collisions) check.take(std::span(&one.pair, 1), std::span(&one.finding, 1));
        check.exclude(excluded_);
        return error_if_any(ErrorCode::engine_failed, [&] { not_checked_ = check.finish().not_checked; });
    }

    /// Returns the message for the collisions with one change.
    std::string complaint_with(Pair pair, const std::function<void(Finding&)>& change) {
        std::vector<Collision> collisions = collisions_;
        for (Collision& one : collisions) {
            if (one.pair == pair) change(one.finding);
        }
        return complaint(collisions);
    }
    std::string complaint_without(Pair pair) {
        std::vector<Collision> collisions = collisions_;
        EXPECT_EQ(std::erase_if(collisions, [&](const Collision& one) { return one.pair == pair; }), 1u);
        return complaint(collisions);
    }

    Scene scene_;
    ExactOptions options_;
    std::optional<double> min_depth_;
    std::vector<Collision> collisions_;
    std::vector<Pair> excluded_;
    std::set<std::string> not_checked_;
};

TEST_F(Stages, PassWhenTheyAreRight) {
    EXPECT_EQ(complaint(collisions_), "");
    EXPECT_EQ(not_checked_, std::set<std::string>{"depths and contacts of meshes"});
}

TEST_F(Stages, EveryLostCollisionIsNamed) {
    for (const Collision& one : collisions_) {
        const std::string name = "pair (" + std::to_string(one.pair.a) + ", " + std::to_string(one.pair.b) + ")";
        EXPECT_EQ(complaint_without(one.pair).find("verification failed: " + name + ": "), 0u) << name;
    }
}

TEST_F(Stages, EveryWrongClassIsNamed) {
    for (const Collision& one : collisions_) {
        const bool apart = one.finding.collision_class == CollisionClass::clearance;
        const auto wrong = apart ? CollisionClass::penetrating : CollisionClass::clearance;
        const std::string text = complaint_with(one.pair, [&](Finding& finding) { finding.collision_class = wrong; });
        EXPECT_TRUE(has_text(text, std::to_string(one.pair.a) + ", " + std::to_string(one.pair.b)))
            << one.pair.a << ' ' << one.pair.b << ": " << text;
    }
    for (const Pair pair : {Pair{0, 2}, Pair{5, 6}}) {
        const auto say_contained = [](Finding& finding) { finding.collision_class = CollisionClass::contained; };
        EXPECT_NE(complaint_with(pair, say_contained), "");
    }
}

TEST_F(Stages, WrongNumbersAreNamed) {
    EXPECT_NE(complaint_with({0, 3}, [](Finding& finding) { finding.distance += 0.01; }), "");
    EXPECT_NE(complaint_with({0, 3}, [](Finding& finding) { finding.distance -= 0.01; }), "");
    EXPECT_NE(complaint_with({5, 6}, [](Finding& finding) { finding.depth += 0.01; }), "");
    EXPECT_NE(complaint_with({5, 6}, [](Finding& finding) { finding.contacts.at(0).depth -= 0.01; }), "");
    EXPECT_NE(complaint_with({5, 6}, [](Finding& finding) { finding.contacts.at(0).point[2] += 2; }), "");
    const double not_a_number = std::numeric_limits<double>::quiet_NaN();
    for (const Collision& one : collisions_) {
        EXPECT_NE(complaint_with(one.pair, [&](Finding& finding) { finding.distance = not_a_number; }), "");
        if (one.finding.collision_class != CollisionClass::clearance) continue;
        EXPECT_NE(complaint_with(one.pair, [](Finding& finding) { finding.nearest[0][1] += 0.01; }), "");
        EXPECT_NE(complaint_with(one.pair,
                                 [](Finding& finding) {
                                     for (Point3d& point : finding.nearest) point[1] += 0.5;
                                 }),
                  "");
    }
}

TEST_F(Stages, WrongFeaturesOfAPlaneAreNamed) {
    using enum CollisionClass;
    const Pair pair{4, 9};  // the sphere is cut to a depth of 0.15
    EXPECT_NE(complaint_with(pair, [](Finding& finding) { finding.depth += 0.01; }), "");
    EXPECT_NE(complaint_with(pair, [](Finding& finding) { finding.collision_class = touching; }), "");
    EXPECT_NE(complaint_with(pair, [](Finding& finding) { finding.collision_class = contained; }), "");
    EXPECT_NE(complaint_with(pair, [](Finding& finding) { finding.contacts.at(0).depth -= 0.01; }), "");
    EXPECT_NE(complaint_with(pair, [](Finding& finding) { finding.contacts.at(0).point[0] += 0.6; }), "");
    EXPECT_NE(complaint_with(pair, [](Finding& finding) { finding.contacts.at(0).normal = {0, 1, 0}; }), "");
}

/// A plane whose origin is a billion away along the plane, where the narrow phase counts a gap of 1e-6 as rounding.
TEST_F(Stages, AFarPlaneMayRound) {
    scene_ = {};
    scene_.add(shape::Sphere{1}, make_pose({0, 0, 1 + 1e-6}));
    scene_.add(shape::Plane{{0, 0, 1}, 0}, make_pose({1e9, 0, 0}));
    options_.margin = 0;
    EXPECT_EQ(complaint(find(scene_, options_)), "");
}

/// Two cubes without a face, one around the other: neither has an inside, so the smaller one is apart from the larger one.
TEST_F(Stages, DistancesOfOpenMeshesAreChecked) {
    scene_ = {};
    for (const double size : {1.0, 0.9}) {
        shape::Mesh mesh = box_mesh({-size, -size, -size}, {size, size, size});
        mesh.triangles.pop_back();
        scene_.add(std::move(mesh));
    }
    collisions_ = find(scene_, options_);
    ASSERT_EQ(collisions_.size(), 1u);
    ASSERT_EQ(collisions_[0].finding.collision_class, CollisionClass::clearance);
    EXPECT_EQ(complaint(collisions_), "");
    EXPECT_NE(complaint_with({0, 1}, [](Finding& finding) { finding.distance += 0.01; }), "");
    EXPECT_NE(complaint_without({0, 1}), "");
}

/// A mesh has a gap of 5e-17, which its position rounds away. The narrow phase sees an open mesh, so the check must, too.
TEST_F(Stages, AGapThatAMotionClosesStaysAGap) {
    scene_ = {};
    shape::Mesh outer = box_mesh({-4.3, -4, -4}, {0.3, 4, 4});
    std::vector<Point3d>& vertices = outer.vertices;
    const std::size_t corner = outer.triangles.back()[0];
    vertices.push_back(vertices[corner]);
    vertices.back()[0] = std::nextafter(vertices[corner][0], 100);
    outer.triangles.back()[0] = std::uint32_t(vertices.size() - 1);
    scene_.add(std::move(outer), make_pose({1e6, 0, 0}));
    scene_.add(box_mesh({-2, -1, -1}, {-1, 1, 1}), make_pose({1e6, 0, 0}));
    options_.margin = 4;
    collisions_ = find(scene_, options_);
    ASSERT_EQ(collisions_.size(), 1u);
    EXPECT_EQ(complaint(collisions_), "");
}

TEST_F(Stages, PairsThatAreNotDeepEnoughMayBeDropped) {
    min_depth_ = 0.2;
    EXPECT_EQ(complaint_without({4, 9}), "");
    EXPECT_NE(complaint_without({7, 8}), "");
}

TEST_F(Stages, CollisionsOfMovingObjectsAreNotJudged) {
    scene_.end_poses = scene_.poses;
    EXPECT_EQ(complaint_without({5, 6}), "");
    EXPECT_EQ(not_checked_, std::set<std::string>{"collisions of moving objects"});
}

TEST_F(Stages, AStrayOrRepeatedCollisionIsNamed) {
    std::vector<Collision> collisions = collisions_;
    collisions.push_back(collisions[0]);
    EXPECT_TRUE(has_text(complaint(collisions), "is twice among the collisions"));
    collisions.back().pair = {1, 11};
    EXPECT_EQ(complaint(collisions), "verification failed: pair (1, 11) is a collision, but not a pair of boxes");
    collisions.back() = {{10, 11}, {}};
    collisions.back().finding.collision_class = CollisionClass::penetrating;
    EXPECT_TRUE(has_text(complaint(collisions), "pair (10, 11): the objects do not meet"));
}

TEST_F(Stages, ExcludedPairsMustBeAbsent) {
    excluded_ = {{5, 6}};
    EXPECT_EQ(complaint(collisions_), "verification failed: pair (5, 6): it is excluded");
    EXPECT_EQ(complaint_without({5, 6}), "");
}

}  // namespace
}  // namespace octopair::test
