// Tests that a scene's steps and queries give the same results for any floating-point state of the caller, and leave it
// unchanged.
#include <gtest/gtest.h>

#include <cfloat>
#include <string>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/compare.hpp"
#include "support/floating_point.hpp"

namespace octopair::test {
namespace {

class SceneFloatingPoint : public ::testing::TestWithParam<CallerState> {};

/// Boxes on a grid of `step`.
std::vector<Box3d> grid_boxes(double step, std::uint32_t seed) {
    std::vector<Box3d> boxes;
    std::uint32_t random = seed;
    for (int i = 0; i < 300; ++i) {
        Box3d box;
        for (int axis = 0; axis < 3; ++axis) {
            random = random * 1664525 + 1013904223;
            box.min[axis] = double(int(random >> 16) % 12) * step;
            box.max[axis] = box.min[axis] + double(int(random >> 28) % 3) * step;
        }
        boxes.push_back(box);
    }
    return boxes;
}

struct Found {
    std::vector<std::vector<Pair>> steps;
    std::vector<std::uint32_t> overlaps;
    std::vector<RayHit> hits, first_hits;
    std::vector<Neighbor> nearest;
};

struct Asked {
    std::vector<Box3d> before, after;
    std::vector<Sphere> spheres;
    std::vector<Ray> rays;
    double margin = 0;

    explicit Asked(double step) : before(grid_boxes(step, 1)), after(grid_boxes(step, 2)), margin(step) {
        for (const Box3d& box : before) {
            spheres.push_back({{box.min[0], box.min[1], box.min[2]}, 3 * step});
            rays.push_back({{box.min[0], box.min[1], box.min[2]}, {step, 2 * step, 3 * step}});
        }
    }
};

Found run(const Asked& asked, unsigned threads) {
    Found found;
    Scene scene({threads, Precision::float64, asked.margin});
    std::vector<ObjectId> ids(asked.before.size());
    scene.add(Objects{std::span(asked.before)}, ids);
    scene.step();
    found.steps.push_back(scene.pairs().to_vector());
    const std::span<const ObjectId> some = std::span(ids).first(20);
    scene.move(some, std::span(asked.after).first(20));
    Answers<std::uint32_t> overlaps;
    scene.overlaps(asked.spheres, overlaps);
    scene.step();
    found.steps.push_back(scene.pairs().to_vector());
    scene.sweep(some, std::span(asked.before).first(20));
    scene.step();
    found.steps.push_back(scene.pairs().to_vector());
    found.overlaps = overlaps.all;
    scene.overlaps(asked.before, overlaps);
    found.overlaps.insert(found.overlaps.end(), overlaps.all.begin(), overlaps.all.end());
    Answers<RayHit> hits;
    scene.all_hits(asked.rays, hits);
    found.hits = hits.all;
    scene.first_hits(asked.rays, hits);
    found.first_hits = hits.all;
    Answers<Neighbor> nearest;
    scene.nearest(asked.after, 7, nearest);
    found.nearest = nearest.all;
    return found;
}

TEST_P(SceneFloatingPoint, ChangesNoAnswers) {
    for (const double step : {0.1, DBL_TRUE_MIN}) {
        const Asked asked(step);
        const Found expected = run(asked, 1);
        for (const auto& pairs : expected.steps) EXPECT_FALSE(pairs.empty());
        for (const unsigned threads : {1u, 2u, 3u}) {
            Found found;
            call_in(GetParam(), [&] { found = run(asked, threads); });
            SCOPED_TRACE(std::to_string(step) + ", " + std::to_string(threads) + " threads");
            ASSERT_EQ(found.steps.size(), expected.steps.size());
            for (std::size_t i = 0; i < found.steps.size(); ++i) {
                EXPECT_TRUE(same_sequence(found.steps[i], expected.steps[i])) << i;
            }
            EXPECT_TRUE(same_sequence(found.overlaps, expected.overlaps));
            EXPECT_TRUE(same_sequence(found.hits, expected.hits));
            EXPECT_TRUE(same_sequence(found.first_hits, expected.first_hits));
            EXPECT_TRUE(same_sequence(found.nearest, expected.nearest));
        }
    }
}

TEST_P(SceneFloatingPoint, IsRestoredAfterAnError) {
    Scene scene({1, Precision::float64});
    const std::vector<Box3d> wrong = {{{2 * DBL_TRUE_MIN, 0, 0}, {DBL_TRUE_MIN, 1, 1}}};
    ObjectId id;
    const auto add = [&] { call_in(GetParam(), [&] { scene.add(Objects{wrong}, std::span(&id, 1)); }); };
    const auto overlaps = [&] { call_in(GetParam(), [&] { (void)scene.overlaps(wrong[0]); }); };
    const auto sphere = [&] { call_in(GetParam(), [&] { (void)scene.overlaps(Sphere{{0, 0, 0}, -DBL_TRUE_MIN}); }); };
    const auto make = [&] { call_in(GetParam(), [&] { Scene({1, Precision::float32, -DBL_TRUE_MIN}); }); };
    EXPECT_THROW(add(), Error);
    EXPECT_THROW(overlaps(), Error);
    EXPECT_THROW(sphere(), Error);
    EXPECT_THROW(make(), Error);
}

INSTANTIATE_TEST_SUITE_P(States, SceneFloatingPoint, ::testing::ValuesIn(caller_states()),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace octopair::test
