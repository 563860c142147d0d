// Tests small histories of scenes with tiny tuning against brute force: every path of scene steps and of mutable
// octrees. In most of the histories calls fail before they succeed.
#include <gtest/gtest.h>

#include <exception>

#include "exactness/small_scenes.hpp"
#include "exactness/tiny_tuning.hpp"
#include "samples/random.hpp"
#include "scene/failing_scene.hpp"
#include "scene/history.hpp"
#include "support/scale.hpp"

#ifdef OCTOPAIR_TEST_HOOKS

namespace octopair::test {
namespace {

constexpr std::uint64_t usual_histories = scaled(5000, 20);
constexpr std::uint64_t history_parts = 4;  // the histories are split, so that several processes can share them

class SmallHistories : public ::testing::TestWithParam<std::uint64_t> {};

/// Returns the name of a family with probability 3/4, otherwise of a kind.
std::string history_name(samples::RandomStream& random) {
    static const auto families = family_names(), kinds = all_kind_names();
    const auto& names = random.below(4) != 0 ? families : kinds;
    return names[random.below(names.size())];
}

/// Returns mostly few objects, because brute force and nested octrees take long for many objects.
HistorySize history_size(samples::RandomStream& random) {
    const std::uint64_t size = random.below(100);
    return {size < 50 ? 20u : size < 95 ? 70u : 300u, 12};
}

TEST_P(SmallHistories, AreWhatBruteForceFinds) {
    // Scale the number of histories with the number of small scenes, unless the environment sets a number of cases.
    const std::uint64_t scenes = scene_range(SceneSize::small, 10'000).size();
    const std::uint64_t count = case_count(std::max<std::uint64_t>(1, usual_histories * scenes / 10'000));
    const SceneRange part = SceneRange{0, count}.part(GetParam(), history_parts);
    FailingScene::Failures failures;
    for (std::uint64_t i = part.begin; i < part.end; ++i) {
        const std::uint64_t seed = case_seed("small histories", i);
        samples::RandomStream random(seed, 2);
        const std::string name = history_name(random);
        SCOPED_TRACE(name + ", OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        const TuningScope tiny(tiny_tuning(seed));
        const auto make = [&](const SceneOptions& options) {
            return FailingScene(options, seed, seed % 4 == 0 ? 0 : 0.3);
        };
        History<FailingScene> history(name, seed, make, history_size(random));
        try {
            history.run();
        } catch (const std::exception& error) {
            FAIL() << error.what();  // the trace names the history
        }
        if (HasFatalFailure()) return;
        failures.add(history.scene().failures());
    }
    if (part.size() < usual_histories / history_parts) return;
    failures.expect_each();
    using enum Path;
    EXPECT_EQ(
        paths_not_taken({change_listed, change_alone, change_joined, run_stopped, unit_in_cell, unit_of_leaf,
                         unit_of_inner, step_full, step_idle, step_incremental, step_too_dear, log_overflowed,
                         octree_rebuilt, octree_for_queries, queries_sorted, pairs_waited, pairs_merged, refilled}),
        "");
}

INSTANTIATE_TEST_SUITE_P(Parts, SmallHistories, ::testing::Range(std::uint64_t(0), history_parts));

}  // namespace
}  // namespace octopair::test

#endif
