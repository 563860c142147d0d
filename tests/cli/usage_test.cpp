// Tests invalid command lines: exit status 2, one line of message, and no side effects.
#include <algorithm>
#include <iterator>
#include <map>
#include <sstream>

#include "cli/program.hpp"

namespace octopair::test {
namespace {

class Usage : public ProgramTest {};

TEST_F(Usage, HelpAndVersionAreAnswers) {
    for (const std::string what : {"--help", "-h", "detect --help", "generate --help", "replay -h", "help",
                                   "help detect", "--version", "-V", "info"}) {
        const Outcome outcome = run(what);
        EXPECT_EQ(outcome.status, 0) << what;
        EXPECT_NE(outcome.out, "") << what;
        EXPECT_EQ(outcome.err, "") << what;
    }
    EXPECT_TRUE(has_text(run("generate --help").out, "brownian"));
    EXPECT_EQ(run("help").out, run("--help").out);
    EXPECT_EQ(run("help detect").out, run("detect --help").out);
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
        "replay a.npy --threads 4097",
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

TEST_F(Usage, FaultsAreNamedWithWhatToDo) {
    save_boxes("a.npy", {0});
    const std::string subcommand = " (see octopair --help)\n", detect = " (see octopair detect --help)\n";
    for (const auto& [arguments, message] : std::map<std::string, std::string>{
             {"find", "find: no such subcommand" + subcommand},
             {"detekt a.npy", "detekt: no such subcommand; did you mean 'detect'?" + subcommand},
             {"Detect a.npy", "Detect: no such subcommand; did you mean 'detect'?" + subcommand},
             {"gen uniform", "gen: no such subcommand; did you mean 'generate'?" + subcommand},
             {"hepl", "hepl: no such subcommand; did you mean 'help'?" + subcommand},
             {"help dtect", "dtect: no such subcommand; did you mean 'detect'?" + subcommand},
             {"version", "version: no such subcommand; did you mean '--version'?" + subcommand},
             {"--verison", "--verison: no such option; did you mean '--version'?" + subcommand},
             {"--quiet", "--quiet: an option of a subcommand; write it after the subcommand" + subcommand},
             {"--quiet detect a.npy", "--quiet: an option of a subcommand; write it after the subcommand" + detect},
             {"detect", "INPUT is missing" + detect},
             {"detect --none a.npy", "--none: no such option of detect" + detect},
             {"detect a.npy --outptu x", "--outptu: no such option of detect; did you mean '--output'?" + detect},
             {"detect a.npy --ouput=x", "--ouput: no such option of detect; did you mean '--output'?" + detect},
             {"detect a.npy --dup 1",
              "--dup: no such option of detect; did you mean '--duplicate-tolerance'?" + detect},
             {"detect a.npy -x", "-x: no such option of detect" + detect},
             {"detect a.npy --output", "--output: a value is missing: --output FILE" + detect},
             {"detect a.npy --margin", "--margin: a value is missing: --margin M" + detect},
             {"detect a.npy -o p.csv -o q.csv", "--output: given 2 times; give it once" + detect},
             {"detect a.npy -o p.csv --count-only", "--output: not with --count-only" + detect},
             {"detect a.npy --order asending",
              "--order: 'asending' is not a valid value; did you mean 'ascending'? Valid values: ascending, octal\n"},
             {"detect a.npy --order x", "--order: 'x' is not a valid value; valid values: ascending, octal\n"},
             {"replay a.npy b.npy", "b.npy: one argument too many (see octopair replay --help)\n"},
             {"generate uniform --objcts 5 -o a.npy",
              "--objcts: no such option of generate; did you mean '--objects'? (see octopair generate --help)\n"},
         }) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.err, "octopair: " + message) << arguments;
    }
    EXPECT_TRUE(run("").err.starts_with("octopair: no subcommand is given; subcommands: detect, generate, "));
    EXPECT_TRUE(
        has_text(run("generate unifrom --objects 5 -o p.npy").err,
                 "KIND: 'unifrom' is not a valid value; did you mean 'uniform'? Valid values: uniform, dense, "));
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"a.npy"});
}

TEST_F(Usage, ThreadsAndWorkersHaveOneLimit) {
    save_boxes("a.npy", {0, 0.5});
    std::vector<std::string> commands = {"detect a.npy", "detect a.npy --events", "replay a.npy"};
#ifdef OCTOPAIR_WITH_VIEWER
    commands.emplace_back("view a.npy");
#endif
#ifdef OCTOPAIR_WITH_SERVICE
    commands.emplace_back("serve --listen unix:s");
    write_file(file("c.toml"), "threads = 4097\n");
    EXPECT_EQ(run("serve --listen unix:s --config c.toml").err,
              "octopair: c.toml: threads: --threads: 4097 is not in the range 0 to 4096\n");
#endif
#ifdef OCTOPAIR_WITH_MPI
    commands.emplace_back("detect a.npy --engine mpi");
#endif
    for (const std::string& command : commands) {
        for (const std::string number : {"4097", "-1", "18446744073709551616"}) {
            EXPECT_EQ(run(command + " --threads " + number).err,
                      "octopair: --threads: " + number + " is not in the range 0 to 4096\n");
        }
        EXPECT_EQ(run(command + " --threads two").err,
                  "octopair: --threads: 'two' is not a whole number from 0 to 4096\n");
    }
    EXPECT_EQ(run("detect a.npy --threads 4096 --count-only").out, "1\n");
}

TEST_F(Usage, OutputHasAShortName) {
    ASSERT_EQ(run("generate uniform --objects 5 -o a.npy").status, 0);
    ASSERT_EQ(run("generate uniform --objects 5 --output b.npy").status, 0);
    EXPECT_EQ(content("a.npy"), content("b.npy"));
    ASSERT_EQ(run("detect a.npy -o p.csv").status, 0);
    EXPECT_EQ(content("p.csv"), run("detect a.npy --quiet").out);
    EXPECT_EQ(run("detect a.npy -o a.npy").err,
              "octopair: --output: a.npy is also an input, which would be replaced\n");
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
                  "octopair: " + option + ": must not be empty (see octopair detect --help)\n");
        EXPECT_EQ(run("detect a.npy " + option + "=").status, 2) << option;
    }
    EXPECT_EQ(run("serve --listen unix:s --tokens ''").status, 2);
    EXPECT_EQ(run("cancel ''").status, 2);
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"a.npy"});
}

/// The help of the program and of its subcommands, at widths of a terminal.
class HelpAtWidths : public ProgramTest {
protected:
    /// Runs the program at a terminal of a width, without the carriage returns of the terminal.
    std::string at_terminal(std::size_t width, const std::string& arguments) const {
        const std::string command = "stty cols " + std::to_string(width) + "; \"$P\" " + arguments;
        std::string out = shell("export P; COLUMNS=70 script -qec '" + command + "' /dev/null").out;
        std::erase(out, '\r');
        return out;
    }
    std::string in_columns(std::size_t width, const std::string& arguments) const {
        return shell("COLUMNS=" + std::to_string(width) + " \"$P\" " + arguments).out;
    }
    std::vector<std::string> commands() const {
        std::vector<std::string> found = {"--help"};
        std::istringstream lines(run("--help").out);
        bool inside = false;
        for (std::string line; std::getline(lines, line);) {
            if (inside && line.empty()) break;
            if (inside && line[2] != ' ') found.push_back(line.substr(2, line.find(' ', 2) - 2) + " --help");
            inside |= line == "Subcommands:";
        }
        return found;
    }
    static std::vector<std::string> lines_of(const std::string& text) {
        std::vector<std::string> lines;
        std::istringstream in(text);
        for (std::string line; std::getline(in, line);) lines.push_back(line);
        return lines;
    }
    static std::vector<std::string> words_of(const std::string& text) {
        std::istringstream in(text);
        return {std::istream_iterator<std::string>(in), {}};
    }
};

TEST_F(HelpAtWidths, LinesFitAndWordsAreWhole) {
    const std::vector<std::string> all = commands();
    ASSERT_GE(all.size(), 6u);
    for (const std::string& command : all) {
        const std::vector<std::string> words = words_of(in_columns(100, command));
        for (const std::size_t width : {40u, 60u, 80u, 120u}) {
            const std::string help = in_columns(width, command);
            EXPECT_EQ(words_of(help), words) << command << width;
            if (width < 60) continue;  // examples need 60
            for (const std::string& line : lines_of(help))
                EXPECT_LE(line.size(), std::min<std::size_t>(width, 100)) << line;
        }
    }
}

TEST_F(HelpAtWidths, DescriptionsHaveAtMostTwoLinesOfAUsualTerminal) {
    for (const std::string& command : commands()) {
        std::size_t continued = 0;
        for (const std::string& line : lines_of(run(command).out)) {
            // A long name has a line of its own. A line of a description is indented by more than the names.
            const bool is_name = line.starts_with("  ") && line[2] != ' ';
            const bool is_continued = line.starts_with("      ");
            if (is_name) continued = line.find("  ", 2) != line.npos ? 1 : 0;
            if (!is_continued) continue;
            ++continued;
            EXPECT_LE(continued, 2u) << command << "\n" << line;
        }
    }
}

TEST_F(HelpAtWidths, IsThatOfTheTerminal) {
    for (const std::size_t width : {60u, 80u, 100u}) {
        EXPECT_EQ(at_terminal(width, "detect --help"), in_columns(width, "detect --help")) << width;
    }
    EXPECT_NE(in_columns(60, "detect --help"), in_columns(80, "detect --help"));
    EXPECT_NE(in_columns(80, "detect --help"), in_columns(100, "detect --help"));
    EXPECT_EQ(at_terminal(1000, "--help"), in_columns(100, "--help"));
    EXPECT_EQ(shell("unset COLUMNS; \"$P\" --help").out, in_columns(80, "--help"));
    EXPECT_EQ(shell("COLUMNS=wide \"$P\" --help").out, in_columns(80, "--help"));
}

TEST_F(HelpAtWidths, OptionsAreInSectionsAndExamplesAtTheEnd) {
    std::vector<std::string> titles, examples;
    for (const std::string& line : lines_of(run("detect --help").out)) {
        if (!titles.empty() && titles.back() == "Examples") examples.push_back(line);
        if (line.ends_with(':') && line[0] != ' ') titles.push_back(line.substr(0, line.size() - 1));
    }
    std::vector<std::string> expected = {"Input",  "What counts", "Exact stages", "Output",
                                         "Engine", "Help",        "Examples"};
#ifdef OCTOPAIR_WITH_SERVICE
    expected.insert(expected.end() - 2, "Server");
#endif
    EXPECT_EQ(titles, expected);
    EXPECT_EQ(examples.size(), 3u);
    for (const std::string& example : examples) EXPECT_TRUE(example.starts_with("  octopair detect ")) << example;
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
