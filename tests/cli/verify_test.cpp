// Tests `octopair detect --verify`: output for correct results, and the options that exclude --verify.
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "base/test_hooks.hpp"
#include "cli/program.hpp"

namespace octopair::test {
namespace {

class DetectVerify : public ProgramTest {
protected:
    void SetUp() override { ASSERT_EQ(run("generate dense --objects 3000 --seed 2 --output a.npy --quiet").status, 0); }

    /// Returns the verification line of the summary, empty if there is none.
    std::string verified(const std::string& arguments) const {
        const Outcome outcome = run("detect a.npy --verify --output p.csv " + arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const std::size_t begin = outcome.err.find("\nverified    ");
        if (begin == std::string::npos) return {};
        return outcome.err.substr(begin + 1, outcome.err.find('\n', begin + 1) - begin - 1);
    }
    void expect_usage(const std::string& arguments, const std::string& words) const {
        const Outcome outcome = run("detect a.npy --verify " + arguments);
        EXPECT_EQ(outcome.status, 2);
        EXPECT_EQ(outcome.err, "octopair: --verify: " + words + "\n");
        EXPECT_EQ(outcome.out, "");
    }
};

TEST_F(DetectVerify, SaysWhatWasChecked) {
    EXPECT_TRUE(has_text(verified(""), " pairs by a second algorithm in "));
    EXPECT_FALSE(has_text(verified(""), "not checked"));
    EXPECT_TRUE(verified("--order octal").ends_with(" (not checked: the order of the pairs)"));
    EXPECT_TRUE(verified("--limit 7").starts_with("verified    7 pairs by a second algorithm in "));
    EXPECT_TRUE(verified("--limit 7 --order octal")
                    .ends_with(" (not checked: the order of the pairs, and which pairs are the first)"));
    EXPECT_NE(verified("--against a.npy --margin 0.001"), "");
    const Outcome counted = run("detect a.npy --verify --count-only");
    EXPECT_EQ(counted.status, 0);
    EXPECT_TRUE(has_text(counted.err, "(not checked: which pairs were counted)"));
    EXPECT_FALSE(has_text(run("detect a.npy").err, "verified"));
}

TEST_F(DetectVerify, GivesTheSameBytes) {
    const std::string plain = run("detect a.npy --quiet").out;
    const Outcome checked = run("detect a.npy --verify --quiet");
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.err, "");
    EXPECT_EQ(checked.out, plain);
}

TEST_F(DetectVerify, StatsHaveTheVerification) {
    EXPECT_EQ(run("detect a.npy --verify --order octal --quiet --output p.npy --stats s.json").status, 0);
    const auto stats = nlohmann::json::parse(content("s.json"));
    EXPECT_EQ(stats.at("verified"), true);
    EXPECT_EQ(stats.at("not_checked"), "the order of the pairs");
    EXPECT_GT(stats.at("seconds").at("verify"), 0);
    EXPECT_EQ(run("detect a.npy --quiet --output p.npy --stats s.json").status, 0);
    const auto plain = nlohmann::json::parse(content("s.json"));
    EXPECT_EQ(plain.at("verified"), false);
    EXPECT_FALSE(plain.at("seconds").contains("verify"));
}

TEST_F(DetectVerify, EachFrameOfAMovingScene) {
    ASSERT_EQ(run("generate brownian --objects 2000 --frames 3 --output m.npy --quiet").status, 0);
    const Outcome outcome = run("detect m.npy --verify --output p.csv --stats s.json");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(nlohmann::json::parse(content("s.json")).at("verified"), true);
}

#ifdef OCTOPAIR_WITH_PROCESSES
TEST_F(DetectVerify, WorkerProcesses) { EXPECT_NE(verified("--engine processes --workers 2"), ""); }
#endif

#ifdef OCTOPAIR_WITH_PIPELINE
TEST_F(DetectVerify, TheCandidatesOfFilters) {
    write_file(file("scene.json"),
               R"({"objects": [{"name": "a", "shape": {"type": "sphere", "radius": 1}},
                               {"name": "b", "shape": {"type": "sphere", "radius": 1}}]})");
    const Outcome outcome = run("detect scene.json --stage objects --verify --output p.csv");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::string line = "verified    1 candidates by a second algorithm, 1 collisions by certificates in ";
    EXPECT_TRUE(has_text(outcome.err, line));
    const Outcome limited = run("detect scene.json --stage objects --verify --limit 1");
    EXPECT_EQ(limited.status, 2);
    EXPECT_EQ(limited.err, "octopair: --verify: not with --limit and filters, which end the search early\n");
}

TEST_F(DetectVerify, WithExclusionsAndMeshes) {
    write_file(file("scene.json"), R"({"objects": [
        {"name": "a", "shape": {"type": "sphere", "radius": 1}},
        {"name": "b", "shape": {"type": "box", "half_extents": [1, 1, 1]}, "position": [0.5, 0, 0]},
        {"name": "c", "shape": {"type": "mesh", "vertices": [[0,0,0],[3,0,0],[0,3,0],[0,0,3]],
                                "triangles": [[0,2,1],[0,1,3],[0,3,2],[1,2,3]]}}]})");
    write_file(file("rules.json"), R"({"exclude": [{"a": "a", "b": "b"}]})");
    const Outcome outcome =
        run("detect scene.json --stage features --verify --exclude rules.json --output p.csv --stats s.json");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const nlohmann::json stats = nlohmann::json::parse(content("s.json"));
    EXPECT_EQ(stats.at("pairs"), 2);
    EXPECT_EQ(stats.at("not_checked"), "exclusion rules; depths and contacts of meshes");
    const Outcome counted = run("detect scene.json --stage objects --verify --count-only --margin 0.1");
    EXPECT_EQ(counted.status, 0) << counted.err;
    EXPECT_EQ(counted.out, "3\n");
}
#endif

#ifdef OCTOPAIR_TEST_HOOKS
class DetectVerifyFaults : public DetectVerify {
protected:
    /// Runs the program with a planted fault.
    Outcome run_with(Fault fault, const std::string& arguments) const {
        TestHooks hooks;
        hooks.fault = fault;
        write_file(file("hooks"), std::string(reinterpret_cast<const char*>(&hooks), sizeof hooks));
        return shell("OCTOPAIR_TEST_HOOKS_FILE=hooks \"$P\" " + arguments);
    }
};

TEST_F(DetectVerifyFaults, ALostPairEndsWithStatus6) {
    const Outcome lost = run_with(Fault::cell_window_end_open, "detect a.npy --verify --quiet --output p.csv");
    EXPECT_EQ(lost.status, 6) << lost.err;
    EXPECT_TRUE(has_text(lost.err, "is missing"));
    EXPECT_FALSE(std::filesystem::exists(file("p.csv")));
}

#ifdef OCTOPAIR_WITH_PIPELINE
TEST_F(DetectVerifyFaults, AWrongClassEndsWithStatus6) {
    write_file(file("scene.json"),
               R"({"objects": [{"name": "a", "shape": {"type": "sphere", "radius": 1}},
                               {"name": "b", "shape": {"type": "sphere", "radius": 1}, "position": [1, 0, 0]}]})");
    const std::string arguments = "detect scene.json --stage features --verify --quiet --output p.csv";
    const Outcome right = run_with(Fault::none, arguments);
    EXPECT_EQ(right.status, 0) << right.err;
    std::filesystem::remove(file("p.csv"));
    const Outcome wrong = run_with(Fault::overlap_called_touching, arguments);
    EXPECT_EQ(wrong.status, 6) << wrong.err;
    EXPECT_TRUE(has_text(wrong.err, "pair (0, 1): its depth is 0, but it is at least 0.99999"));
    EXPECT_FALSE(std::filesystem::exists(file("p.csv")));
}
#endif
#endif

TEST_F(DetectVerify, IsRefusedWhereItCannotBeDone) {
    expect_usage("--events", "not with --events; without it, the pairs of each frame are verified");
}

}  // namespace
}  // namespace octopair::test
