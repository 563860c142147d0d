// Tests `octopair-bench paper` with short runs.
#include <nlohmann/json.hpp>

#include "cli/program.hpp"

namespace octopair::test {
namespace {

class Bench : public ProgramTest {};

TEST_F(Bench, PaperWritesTextAndJson) {
    const Outcome outcome = run("paper --objects 2000 1000 --rounds 3 --threads 2 --json f");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_TRUE(has_text(outcome.out, "Figure 5: run time in milliseconds, uniform"));
    EXPECT_TRUE(has_text(outcome.out, "Run time in microseconds, 2,000 objects"));
    EXPECT_TRUE(has_text(outcome.out, "holds better"));
    const auto json = nlohmann::json::parse(content("f"));
    EXPECT_EQ(json["scene"], "uniform");
    EXPECT_TRUE(json.contains("commit") && json.contains("processor") && json.contains("cores"));
    ASSERT_EQ(json["series"].size(), 5u);
    for (const auto& series : json["series"]) {
        for (const auto& point : series["points"]) {
            EXPECT_EQ(point["seconds"].size(), 3u);
            EXPECT_GT(point["median_seconds"], 0);
            EXPECT_EQ(point["pairs"], json["series"][0]["points"][point["objects"] == 1000 ? 0 : 1]["pairs"]);
        }
    }
    EXPECT_EQ(json["series"][0]["points"][0]["objects"], 1000);
    EXPECT_EQ(json["published"]["tables"][0]["times"][0]["microseconds"], 29'537'415);
}

TEST_F(Bench, PaperTakesAnyScene) {
    const Outcome outcome = run("paper --scene clustered --objects 500 --rounds 1 --threads 1 --quiet");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(has_text(outcome.out, ", clustered\n"));
    EXPECT_EQ(directory_.names(), std::vector<std::string>{});
}

TEST_F(Bench, AResultThatCannotBeWrittenIsKnownBefore) {
    const Outcome outcome = run("paper --json none/f");
    EXPECT_EQ(outcome.status, 4);
    EXPECT_EQ(outcome.out, "");
}

TEST_F(Bench, Interrupted) {
    const Outcome outcome = shell(
        "\"$P\" paper --objects 100000 --rounds 1000 --threads 1 --json f & child=$!; hears $child; sleep 0.5; "
        "kill -INT $child; wait $child");
    EXPECT_EQ(outcome.status, 130) << outcome.err;
    EXPECT_EQ(outcome.err, "octopair-bench: interrupted\n");
    EXPECT_EQ(directory_.names(), std::vector<std::string>{});
}

}  // namespace
}  // namespace octopair::test
