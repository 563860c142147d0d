// Tests scenes on random histories of additions, moves, sweeps, removals and new traits. Brute force checks each step
// and the queries between steps.
#include <gtest/gtest.h>

#include "scene/history.hpp"
#include "support/cases.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t histories_per_kind = test::scaled(30, 2);

class SceneProperty : public ::testing::TestWithParam<std::string> {};

TEST_P(SceneProperty, EveryStepIsWhatBruteForceFinds) {
    int full = 0, partial = 0;
    const std::uint64_t count = test::case_count(histories_per_kind);
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t seed = test::case_seed(GetParam(), i);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        test::History<Scene> history(GetParam(), seed, [](const SceneOptions& options) { return Scene(options); });
        history.run();
        if (HasFatalFailure()) return;
        full += history.model().full();
        partial += history.model().partial();
    }
    EXPECT_GT(full, 0);
    EXPECT_GT(partial, 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, SceneProperty, ::testing::ValuesIn(test::all_kind_names()), test::param_name);

}  // namespace
}  // namespace octopair::test
