// Tests that a pipeline of exact filters may run out of memory at each of its allocations, and then be used again.
#include <gtest/gtest.h>

#include "pipeline/exact_scene.hpp"
#include "samples/meshes.hpp"
#include "support/at_allocation.hpp"

namespace octopair::test {
namespace {

/// Returns shapes of all kinds that meet, near each other and inside one another.
Scene mixed_scene() {
    Scene scene;
    scene.add(box_mesh({0, 0, 0}, {2, 2, 2}));
    scene.add(box_mesh({0, 0, 0}, {1, 1, 1}), make_pose({0.9, 0.8, 0.7}));
    scene.add(shape::Sphere{0.5}, make_pose({2, 1, 1}));
    scene.add(shape::Capsule{0.3, 1}, make_pose({0.2, 0.1, 0.3}));
    scene.add(shape::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1, 0.1, 0.1}}},
              make_pose({1.5, 1.5, 1.5}));
    scene.add(shape::Ellipsoid{{0.2, 0.3, 0.4}}, make_pose({1, 1, 1}));
    scene.add(shape::Cone{0.5, 1}, make_pose({2.4, 1, 1}));
    scene.add(shape::Plane{{0, 0, 1}, -0.2});
    return scene;
}

bool equal(const std::vector<Collision>& a, const std::vector<Collision>& b) {
    const auto is_equal = [](const Collision& one, const Collision& other) {
        return one.pair == other.pair && one.finding.collision_class == other.finding.collision_class &&
               one.finding.depth == other.finding.depth && one.finding.distance == other.finding.distance;
    };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), is_equal);
}

class EveryAllocation : public ::testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(, EveryAllocation, ::testing::Values(1u, 3u));

TEST_P(EveryAllocation, OfAPipelineMayFail) {
    const Scene scene = mixed_scene();
    ExactOptions options;
    options.margin = 0.05;
    const std::vector<Collision> expected = find(scene, options, GetParam());
    EXPECT_GT(expected.size(), 6u);
    struct Run {
        std::unique_ptr<Engine> engine;
        std::unique_ptr<Pipeline> pipeline;
        std::vector<Collision> found;
    };
    const ShapedObjects objects = scene.objects();
    const std::vector<Box3d> boxes = boxes_of(objects);
    Options search{.margin = options.margin};
    const auto run = [&](Run& made) {
        if (!made.pipeline) {
            auto pipeline = std::make_unique<Pipeline>(GetParam());
            pipeline->add(make_exact_object_filter(objects, options));
            pipeline->add(make_exact_feature_filter(objects, options));
            made.pipeline = std::move(pipeline);
        }
        const CollisionSink sink = [&](const Batch& batch) {
            for (std::size_t i = 0; i < batch.pairs().size(); ++i)
                made.found.push_back({batch.pairs()[i], batch.findings()[i]});
        };
        made.pipeline->run(*made.engine, {std::span(boxes), scene.padding}, sink, search);
    };
    const auto make = [] { return Run{make_local_engine(GetParam()), nullptr, {}}; };
    const std::uint64_t failures = fail_every_allocation(make, run, [&](Run& made, bool failed) {
        if (failed) {
            made.found.clear();
            run(made);
        }
        EXPECT_TRUE(equal(made.found, expected));
    });
    EXPECT_GT(failures, 50u);
}

TEST(EveryAllocationOfAGeometry, MayFail) {
    std::uint64_t failures = 0;
    const std::vector<shape::Any> shapes = {box_mesh({0, 0, 0}, {2, 2, 2}),
                                            shape::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                            shape::Sphere{1}};
    for (const shape::Any& shape : shapes) {
        failures += fail_every_allocation(
            [] { return std::optional<Geometry>(); }, [&](std::optional<Geometry>& made) { made.emplace(shape); },
            [](std::optional<Geometry>& made, bool failed) { EXPECT_EQ(made.has_value(), !failed); });
    }
    EXPECT_GT(failures, 10u);
}

}  // namespace
}  // namespace octopair::test
