// Tests the command line of octopair-bench: wrong options give exit status 2 and one line, and no measurement starts.
#include <algorithm>

#include "cli/program.hpp"

namespace octopair::test {
namespace {

class BenchUsage : public ProgramTest {};

TEST_F(BenchUsage, HelpAndVersionAreAnswers) {
    for (const std::string what : {"--help", "paper --help", "help", "help paper", "--version", "-V"}) {
        const Outcome outcome = run(what);
        EXPECT_EQ(outcome.status, 0) << what;
        EXPECT_NE(outcome.out, "") << what;
        EXPECT_EQ(outcome.err, "") << what;
    }
}

TEST_F(BenchUsage, WrongOptionsAreRefused) {
    const std::vector<std::string> wrong = {
        "",
        "nothing",
        "paper --objects",
        "paper --objects 1",
        "paper --objects 1000 many",
        "paper --objects 4294967296",
        "paper --threads 4097",
        "paper --rounds 0",
        "paper --scene nothing",
        "paper a.npy",
        "paper --machines 0",
        "paper --machines 2 --threads 1",
        "paper --machines 2 --bandwidth 0",
        "paper --latency 5",
        "cluster --ranks 0",
        "cluster --scene nothing",
        "cluster --rounds none",
        "cluster a.npy",
        "cluster --arrangement other",
        "cluster --ranks-per-machine 0",
        "scaling --cores 0",
        "scaling --cores 1 4097",
        "scaling --threads-per-rank none",
        "scaling a.npy",
    };
    for (const std::string& arguments : wrong) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(outcome.err.starts_with("octopair-bench: ")) << arguments << "\n" << outcome.err;
        EXPECT_FALSE(has_text(outcome.err, "(octopair --help"));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(directory_.names(), std::vector<std::string>{}) << arguments;
    }
}

TEST_F(BenchUsage, SimilarNamesAreSuggested) {
    EXPECT_EQ(run("papr").err,
              "octopair-bench: papr: no such subcommand; did you mean 'paper'? (see octopair-bench --help)\n");
    EXPECT_EQ(run("paper --thraeds 2").err,
              "octopair-bench: --thraeds: no such option of paper; did you mean '--threads'? (see octopair-bench paper "
              "--help)\n");
    EXPECT_TRUE(has_text(run("paper --scene unifrom").err, "did you mean 'uniform'?"));
    EXPECT_EQ(run("paper --threads 4097").err, "octopair-bench: --threads: 4097 is not in the range 0 to 4096\n");
}

}  // namespace
}  // namespace octopair::test
