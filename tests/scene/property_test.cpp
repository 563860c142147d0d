// Tests scenes on random histories of additions, moves, sweeps, removals and new traits. Brute force checks each step
// and the queries between steps. In half of the histories calls fail before they succeed. Some histories are recorded and replayed.
#include <gtest/gtest.h>

#include "io/temporary.hpp"
#include "scene/failing_scene.hpp"
#include "scene/history.hpp"
#include "scene/recording/replay.hpp"
#include "scene/recording_source.hpp"
#include "support/cases.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t histories_per_kind = scaled(30, 2);

class SceneProperty : public ::testing::TestWithParam<std::string> {
protected:
    /// Runs a history, and adds its numbers of steps and failures. `failing`: as in FailingScene. `recording`: as in SceneOptions.
    void run(std::uint64_t seed, double failing, const std::string& recording) {
        const auto make = [&](SceneOptions options) {
            options.recording = recording;
            return FailingScene(options, seed, failing);
        };
        History<FailingScene> history(GetParam(), seed, make);
        history.run();
        full_ += history.model().full();
        partial_ += history.model().partial();
        failures_.add(history.scene().failures());
    }

    int full_ = 0, partial_ = 0;
    FailingScene::Failures failures_;
};

TEST_P(SceneProperty, EveryStepIsWhatBruteForceFinds) {
    const TemporaryDirectory directory;
    const std::uint64_t count = case_count(histories_per_kind);
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t seed = case_seed(GetParam(), i);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        const std::string recording = seed % 6 < 2 ? directory.file("r.rec") : "";
        run(seed, seed % 2 == 0 ? 0.3 : 0, recording);
        if (HasFatalFailure()) return;
        if (recording.empty()) continue;
        const std::string bytes = read_file(recording);
        RecordingReader reader(source_of(bytes));
        EXPECT_EQ(replay(reader, {1, true}).steps, std::uint64_t(HistorySize().steps));
    }
    EXPECT_GT(full_, 0);
    EXPECT_GT(partial_, 0);
    if (count < 10) return;
    failures_.expect_each();
}

INSTANTIATE_TEST_SUITE_P(Kinds, SceneProperty, ::testing::ValuesIn(all_kind_names()), param_name);

}  // namespace
}  // namespace octopair::test
