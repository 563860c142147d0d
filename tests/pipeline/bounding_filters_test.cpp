// Tests that bounding spheres and oriented boxes reject many pairs, and never a colliding pair.
#include <gtest/gtest.h>

#include <vector>

#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/motion/motion.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/filters.hpp"
#include "pipeline/flow.hpp"
#include "samples/meshes.hpp"
#include "samples/random.hpp"

namespace octopair::test {
namespace {

using samples::random_pose;
using samples::RandomStream;

/// Long and short objects, many of which are near each other.
struct Crowd {
    std::vector<Geometry> geometries;
    std::vector<std::uint32_t> geometry;
    std::vector<Pose> poses, end_poses;
    std::vector<double> padding;

    explicit Crowd(std::size_t count, bool moving = false) {
        RandomStream random(31, moving);
        geometries.emplace_back(shape::Box{{0.05, 0.1, 1}});
        geometries.emplace_back(shape::Capsule{0.1, 2});
        geometries.emplace_back(shape::Ellipsoid{{0.2, 0.4, 0.6}});
        geometries.emplace_back(shape::ConvexHull{{{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 1.2}}});
        for (std::size_t i = 0; i < count; ++i) {
            geometry.push_back(std::uint32_t(random.below(geometries.size())));
            poses.push_back(random_pose(random, 4));
            if (moving) end_poses.push_back(random_pose(random, 4));
            padding.push_back(random.uniform(0, 0.1));
        }
    }
    ShapedObjects all() const { return {geometries, geometry, poses, end_poses, padding}; }
    const ConvexSolid& solid(std::size_t i) const { return detail::prepared(geometries[geometry[i]]).convex; }
};

std::vector<Pair> left_by(std::unique_ptr<Filter> filter, const Crowd& crowd) {
    // All boxes are equal, so every pair reaches the filter.
    const std::vector<Box3f> boxes(crowd.poses.size(), Box3f{{0, 0, 0}, {1, 1, 1}});
    Pipeline pipeline(1);
    pipeline.add(std::move(filter));
    Outcome outcome;
    const auto engine = make_local_engine(1);
    pipeline.run(*engine, all_of(boxes), into(outcome));
    return outcome.pairs;
}

void expect_sound(const Crowd& crowd, double margin, const std::vector<Pair>& left, double max_left) {
    std::vector<std::vector<bool>> kept(crowd.poses.size(), std::vector<bool>(crowd.poses.size()));
    for (const Pair& pair : left) kept[pair.a][pair.b] = true;
    std::size_t pairs = 0;
    for (std::size_t a = 0; a < crowd.poses.size(); ++a) {
        for (std::size_t b = a + 1; b < crowd.poses.size(); ++b) {
            ++pairs;
            if (kept[a][b]) continue;
            const double reach = margin + (crowd.padding[a] + crowd.padding[b]);
            EXPECT_FALSE(convex_within({crowd.solid(a), crowd.poses[a]}, {crowd.solid(b), crowd.poses[b]}, reach));
        }
    }
    EXPECT_LT(double(left.size()), max_left * double(pairs));
}

TEST(BoundingFilters, LeaveOutNothingThatCounts) {
    const Crowd crowd(150);
    for (const double margin : {0.0, 0.3}) {
        const auto by_balls = left_by(make_sphere_filter(crowd.all(), margin), crowd);
        const auto by_boxes = left_by(make_oriented_box_filter(crowd.all(), margin), crowd);
        expect_sound(crowd, margin, by_balls, 0.6);
        expect_sound(crowd, margin, by_boxes, 0.4);
        EXPECT_LT(by_boxes.size(), by_balls.size());
    }
}

TEST(BoundingFilters, MovingObjectsAreJudgedAllTheWay) {
    const Crowd crowd(60, true);
    const auto left = left_by(make_oriented_box_filter(crowd.all(), 0.1), crowd);
    EXPECT_EQ(left.size(), left_by(make_sphere_filter(crowd.all(), 0.1), crowd).size());
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < crowd.poses.size(); ++i) {
        motions.push_back(*Motion::between(crowd.poses[i], crowd.end_poses[i]));
    }
    for (int step = 0; step <= 20; ++step) {
        Crowd now = crowd;
        for (std::size_t i = 0; i < motions.size(); ++i) now.poses[i] = motions[i].at(step / 20.0);
        expect_sound(now, 0.1, left, 0.999);
    }
}

TEST(BoundingFilters, PlanesAndEmptyMeshes) {
    Crowd crowd(0);
    crowd.geometries = {Geometry(shape::Plane{{0, 0, 1}, 0}), Geometry(shape::Box{{3, 3, 0.1}}),
                        Geometry(shape::Mesh{})};
    crowd.geometry = {0, 1, 1, 2};
    crowd.poses = {Pose{}, make_pose({0, 0, 0.1}), make_pose({0, 0, 0.5}), Pose{}};
    using Pairs = std::vector<Pair>;
    EXPECT_EQ(left_by(make_oriented_box_filter(crowd.all()), crowd), (Pairs{{0, 1}}));
    EXPECT_EQ(left_by(make_sphere_filter(crowd.all()), crowd), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
    EXPECT_EQ(left_by(make_oriented_box_filter(crowd.all(), 0.45), crowd), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
}

}  // namespace
}  // namespace octopair::test
