// Tests scenes with slack: enlarged boxes save searches, and do not change the pairs.
#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

SceneOptions with_slack(double slack) {
    SceneOptions options{.threads = 2, .slack = slack};
    return options;
}

std::vector<ObjectId> add(Scene& scene, std::span<const Box3f> boxes) {
    std::vector<ObjectId> ids(boxes.size());
    scene.add(Objects{boxes}, ids);
    return ids;
}

Box3f unit_at(float x) { return {{x, 0, 0}, {x + 1, 1, 1}}; }

TEST(Slack, MustBeAFiniteLength) {
    EXPECT_THROW((Scene{with_slack(-1)}), Error);
    EXPECT_THROW((Scene{with_slack(std::nan(""))}), Error);
    EXPECT_THROW((Scene{with_slack(std::numeric_limits<double>::infinity())}), Error);
}

TEST(Slack, PairsOfEnlargedBoxesStayWhileObjectsStayWithinThem) {
    Scene scene(with_slack(0.5));
    const std::vector<Box3f> boxes = {unit_at(0), unit_at(1.5f)};
    const auto ids = add(scene, boxes);
    EXPECT_EQ(scene.step().pairs(), 0u);
    EXPECT_EQ(scene.enlarged_pairs().size(), 1u);
    for (const float x : {1.2f, 1.0f, 1.1f}) {
        scene.move(std::span(&ids[1], 1), std::vector{unit_at(x)});
        const StepResult& step = scene.step();
        EXPECT_FALSE(step.full) << x;
        EXPECT_EQ(step.pairs(), x <= 1 ? 1u : 0u) << x;
        EXPECT_EQ(scene.enlarged_pairs().size(), 1u) << x;
    }
    EXPECT_EQ(scene.overlaps(Box3d{{1, 0, 0}, {1.05, 1, 1}}), (std::vector<std::uint32_t>{0}));
    scene.move(std::span(&ids[1], 1), std::vector{unit_at(3)});
    EXPECT_EQ(scene.overlaps(Box3d{{3.5, 0, 0}, {3.5, 1, 1}}), (std::vector<std::uint32_t>{1}));
    EXPECT_EQ(scene.step().pairs(), 0u);
    EXPECT_EQ(scene.enlarged_pairs().size(), 0u);
}

TEST(Slack, DriftingObjectsHaveThePairsOfAFullDetection) {
    const std::uint64_t objects = scaled(30'000, 10);
    std::vector<Box3f> boxes = samples::make_scene("uniform", objects, 1);
    const float width = boxes[0].max[0] - boxes[0].min[0];
    Scene scene(with_slack(width / 4));
    const auto ids = add(scene, boxes);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> way(-width / 40, width / 40);
    int full = 0;
    for (int step = 0; step < 30; ++step) {
        const StepResult& result = scene.step();
        full += result.full ? 1 : 0;
        ASSERT_EQ(scene.pairs().to_vector(), find_pairs(boxes)) << "step " << step;
        for (Box3f& box : boxes) {
            for (int axis = 0; axis < 3; ++axis) {
                const float by = way(random);
                box.min[axis] += by;
                box.max[axis] += by;
            }
        }
        scene.move(ids, std::span<const Box3f>(boxes));
    }
    EXPECT_LT(full, 20);
}

TEST(Slack, AStepThatHasNoRoomCanBeRepeated) {
    std::uint64_t left = 0;
    int failures = 0;
    for (std::uint64_t budget = 0; budget < 20'000'000; budget += sanitized ? 4'000'000 : 500'000) {
        SceneOptions options = with_slack(0.5);
        options.room_for_pairs = [&](std::uint64_t bytes) {
            if (bytes > left) throw std::runtime_error("no room");
            left -= bytes;
        };
        Scene scene(options);
        left = 100'000'000;
        (void)add(scene, std::vector(10, unit_at(0)));
        ASSERT_EQ(scene.step().pairs(), 45u);
        (void)add(scene, std::vector(1000, unit_at(0)));
        left = budget;
        try {
            (void)scene.step();
            continue;
        } catch (const std::runtime_error&) {
            ++failures;
        }
        EXPECT_EQ(scene.pairs().size(), 45u);
        left = 100'000'000;
        const StepResult& step = scene.step();
        EXPECT_EQ(step.pairs(), 1010u * 1009 / 2);
        EXPECT_EQ(step.began.size(), 1010u * 1009 / 2 - 45);
        EXPECT_EQ(scene.pairs().size(), 1010u * 1009 / 2);
    }
    EXPECT_GT(failures, sanitized ? 1 : 3);
}

}  // namespace
}  // namespace octopair::test
