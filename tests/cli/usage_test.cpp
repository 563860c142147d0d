// Tests invalid command lines: exit status 2, one line of message, and no side effects.
#include "cli/program.hpp"

namespace octopair::test {
namespace {

class Usage : public ProgramTest {};

TEST_F(Usage, HelpAndVersionAreAnswers) {
    for (const std::string what :
         {"--help", "detect --help", "generate --help", "replay --help", "--version", "info"}) {
        const Outcome outcome = run(what);
        EXPECT_EQ(outcome.status, 0) << what;
        EXPECT_NE(outcome.out, "") << what;
        EXPECT_EQ(outcome.err, "") << what;
    }
    EXPECT_TRUE(has_text(run("generate --help").out, "brownian"));
    EXPECT_TRUE(has_text(run("info").out, "engines          local"));
}

TEST_F(Usage, WrongOptionsAreRefused) {
    save_boxes("a.npy", {0});
    const std::vector<std::string> wrong = {
        "",
        "find",
        "detect",
        "detect a.npy --none",
        "detect a.npy --margin -1",
        "detect a.npy --margin nan",
        "detect a.npy --margin inf",
        "detect a.npy --margin 1e999",
        "detect a.npy --margin 1m",
        "detect a.npy --output p.csv --stats p.csv",
        "detect a.npy --output p.csv --stats ./p.csv",
        "detect a.npy --margin ''",
        "detect a.npy --limit -1",
        "detect a.npy --limit 1.5",
        "detect a.npy --limit 18446744073709551616",
        "detect a.npy --threads two",
        "detect a.npy --threads 100000",
        "detect a.npy --workers 2",
        "detect a.npy --order random",
        "detect a.npy --index-type float32",
        "detect a.npy --index-type uint64 --output p.npy",
        "detect a.npy --index-type uint64 --engine mpi",
        "detect a.npy --objects edge",
        "detect a.npy --stage objects",
        "detect a.npy --stage features",
        "detect a.obj --baseline a.csv",
        "detect a.obj --stage objects --index-type uint64 --engine mpi --output p.npy",
        "detect a.npy --same-parent maybe",
        "detect a.npy --same-parent exclude --events",
        "detect a.npy --engine mpi --workers 2",
        "detect a.npy --engine unix:",
        "detect a.npy --engine localhost:70000",
        "detect a.npy --engine quantum",
        "detect a.npy --events --output p.npy",
        "detect a.npy --events --count-only",
        "detect a.npy --events --order octal",
        "detect a.npy --events --workers 2",
        "detect a.npy --output p",
        "detect a.npy --output p.txt",
        "detect a.npy --output p.csv --count-only",
        "detect a.npy --verify --index-type uint64 --engine mpi --output p.npy",
        "detect - --engine mpi",
        "detect a.obj --objects triangle --stage features --duplicate-tolerance 1",
        "detect a.obj --objects triangle --weld 1",
        "detect a.obj --stage objects --tolerance 1",
        "detect a.npy --engine localhost:1:2",
        "detect a.npy --engine [localhost]:1",
        "detect a.npy --engine 'local host:1'",
        "detect a.npy --engine unix:" + std::string(108, 'x'),
        "generate",
        "generate uniform",
        "generate uniform --objects 5",
        "generate nothing --objects 5 --output p.npy",
        "generate uniform --objects -5 --output p.npy",
        "generate uniform --objects 4294967296 --output p.npy",
        "generate uniform --objects 5 --seed x --output p.npy",
        "generate uniform --objects 5 --frames 0 --output p.npy",
        "generate uniform --objects 5 --frames 2 --output p.npy",
        "generate uniform --objects 5 --output p.csv",
        "replay",
        "replay a.npy b.npy",
        "replay a.npy --threads 1025",
        "replay a.npy --output p.csv",
        "serve",
        "serve --listen unix:s --rank-timeout 5",
    };
    for (const std::string& arguments : wrong) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(outcome.err.starts_with("octopair: ")) << arguments << "\n" << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"a.npy"});
}

TEST_F(Usage, UnknownSubcommandsAreNamed) {
    EXPECT_EQ(run("detec a.npy").err, "octopair: detec: no such subcommand (see octopair --help)\n");
    EXPECT_EQ(run("--quiet").err, "octopair: --quiet: no such subcommand (see octopair --help)\n");
    EXPECT_EQ(run("").err, "octopair: A subcommand is required (see octopair --help)\n");
    EXPECT_EQ(run("detect --none a.npy").err,
              "octopair: The following argument was not expected: --none (see octopair --help)\n");
}

/// A script whose variable is not set writes an empty word. Without a join, a file or tokens the program would do something else.
TEST_F(Usage, EmptyValuesAreRefused) {
    save_boxes("a.npy", {0});
    std::vector<std::string> options = {"--against", "--padding", "--output", "--stats"};
#ifdef OCTOPAIR_WITH_SERVICE
    options.emplace_back("--token-file");
#endif
    for (const std::string& option : options) {
        EXPECT_EQ(run("detect a.npy " + option + " ''").err,
                  "octopair: " + option + ": must not be empty (see octopair --help)\n");
        EXPECT_EQ(run("detect a.npy " + option + "=").status, 2) << option;
    }
    EXPECT_EQ(run("serve --listen unix:s --tokens ''").status, 2);
    EXPECT_EQ(run("cancel ''").status, 2);
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"a.npy"});
}

#ifndef OCTOPAIR_WITH_PIPELINE
TEST_F(Usage, WhatWasLeftOutIsSaid) {
    save_boxes("a.npy", {0});
    EXPECT_EQ(run("detect a.npy --stage features").err,
              "octopair: --stage: this octopair was built without 'features'; it has: pairs\n");
    EXPECT_EQ(run("detect a.npy --stage pairs --engine local --quiet").status, 0);
}
#endif

}  // namespace
}  // namespace octopair::test
