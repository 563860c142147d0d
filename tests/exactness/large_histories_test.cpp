// Tests large scenes of every family that change step by step, against the second algorithm (src/verification).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "exactness/large_history.hpp"
#include "exactness/small_scenes.hpp"
#include "support/families.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t min_history_objects = scaled(40'000, 10), max_history_objects = scaled(200'000, 10);

std::uint64_t object_count(std::uint64_t seed) {
    samples::RandomStream random(seed, 4);
    return std::uint64_t(double(min_history_objects) *
                         std::pow(double(max_history_objects) / double(min_history_objects), random.uniform()));
}

TEST(LargeHistories, AreWhatTheSecondAlgorithmFinds) {
#ifdef OCTOPAIR_TEST_HOOKS
    const TuningScope tuning(default_tuning);  // restores the tuning that the histories change
#endif
    const auto families = family_names();
    // A fifth of the number of large scenes, because a history takes as long as five of them; in long runs as many as there are scenes. The
    // environment can set another number of cases.
    constexpr std::uint64_t long_run = 1000;
    const std::uint64_t scenes = scene_range(SceneSize::large, 20).size();
    const std::uint64_t count = case_count(scenes < long_run ? scenes / 5 : scenes);
    const std::uint64_t max_tried = 4 * count;
    std::uint64_t done = 0, full_steps = 0, partial_steps = 0, failures = 0;
    for (std::uint64_t i = 0; i < max_tried && done < count; ++i) {
        const std::uint64_t seed = case_seed("large histories", i);
        const std::string& family = families[seed % families.size()];
        LargeHistory history(family, object_count(seed), seed);
        if (history.has_too_many_pairs()) continue;
        const auto finding = history.run();
        ASSERT_FALSE(finding) << finding->check << ": " << finding->text << "; OCTOPAIR_TEST_SEED=" << seed
                              << ": family " << family << ", " << history.describe();
        ++done;
        full_steps += history.full_steps();
        partial_steps += history.partial_steps();
        const FailingScene::Failures failed = history.failures();
        failures += failed.allocations + failed.refusals + failed.stops;
    }
    std::printf("%llu histories, %llu full steps, %llu partial steps\n", static_cast<unsigned long long>(done),
                static_cast<unsigned long long>(full_steps), static_cast<unsigned long long>(partial_steps));
    if (count < 4) return;
    EXPECT_EQ(done, count);
    EXPECT_GT(full_steps, 0U);
    EXPECT_GT(failures, 0U);
    // Without test hooks a scene chooses by measured times.
    EXPECT_TRUE(partial_steps > 0 || !has_test_hooks);
}

/// A scene whose full steps once gave pairs twice, so that pairs of objects that had moved away stayed in the list.
TEST(LargeHistories, ForgetThePairsOfWhatMovesAway) {
    const std::vector<Box3f> boxes = long_tailed_boxes(scaled(40'000, 4), 2);
    Scene scene(SceneOptions{.threads = 2});
    std::vector<ObjectId> ids(boxes.size());
    scene.add(Objects{boxes}, ids);
    const std::uint64_t all = scene.step().began.size();
    const auto expect_without = [&](std::size_t gone) {
        for (const auto chunk : scene.pairs().chunks()) {
            for (const Pair& pair : chunk) {
                ASSERT_NE(pair.a, ids[gone].index);
                ASSERT_NE(pair.b, ids[gone].index);
            }
        }
    };
    std::uint64_t ended = 0;
    for (std::size_t i = 0; i < 200; ++i) {
        const std::vector<Box3f> away = {{{100, 100, float(i) * 10}, {101, 101, float(i) * 10 + 1}}};
        scene.move(std::span(ids).subspan(i, 1), std::span<const Box3f>(away));
        const StepResult& result = scene.step();
        EXPECT_TRUE(result.began.empty());
        ended += result.ended.size();
        if (i % 20 == 0) expect_without(i);
    }
    EXPECT_EQ(scene.pairs().size(), all - ended);
}

}  // namespace
}  // namespace octopair::test
