// Tests the options of `octopair serve`, in a file and on the command line, and the refused options.
#include <utility>
#include <vector>

#include "cli/program.hpp"

namespace octopair::test {
namespace {

class ServeOptions : public ProgramTest {
protected:
    /// Returns the error message for a configuration file with these lines. Expects that the program does not listen.
    std::string refused(const std::string& lines, int status = 2) const {
        write_file(file("c.toml"), lines);
        const Outcome outcome = run("serve --config c.toml --listen unix:socket");
        EXPECT_EQ(outcome.status, status) << lines << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(file("socket"))) << lines;
        return outcome.err;
    }
    /// Starts the server, waits until its socket exists, and stops the server.
    Outcome served(const std::string& arguments) const {
        return shell("\"$P\" serve " + arguments + R"( 2>log & child=$!
            for i in $(seq 1200); do
                [ -S socket ] && break
                kill -0 $child 2>/dev/null || break
                sleep 0.05
            done
            kill $child; wait $child)");
    }
};

TEST_F(ServeOptions, UnknownKeysNameFileAndKey) {
    EXPECT_EQ(refused("max-jbos = 5\n"),
              "octopair: c.toml: max-jbos: not an option of 'serve'; did you mean 'max-jobs'?\n");
    EXPECT_EQ(refused("max-jobs = 5\nmax-jobs = 6\n"), "octopair: c.toml: max-jobs: set twice\n");
    EXPECT_EQ(refused("max-jobs = \x1B[1m\n", 3), "octopair: c.toml: not a text file of at most 1 MiB\n");
    EXPECT_EQ(refused(std::string((1 << 20) + 1, '#'), 3), "octopair: c.toml: not a text file of at most 1 MiB\n");
    EXPECT_EQ(refused("config = 'd.toml'\n"), "octopair: c.toml: config: not an option of 'serve'\n");
}

TEST_F(ServeOptions, WrongValuesNameFileAndKey) {
    EXPECT_EQ(refused("max-jobs = many\n").find("octopair: c.toml: max-jobs: --max-jobs: 'many' is not a whole number"),
              0u);
    EXPECT_EQ(
        refused("max-memory = \"8 GB\"\n"),
        "octopair: c.toml: max-memory: --max-memory: '8 GB' is not a number of bytes, for example 65536, 64K or 4G\n");
    EXPECT_EQ(refused("stall = 0\n"), "octopair: c.toml: stall: --stall: at least 1 second\n");
    EXPECT_EQ(refused("keep = 0\n"), "octopair: c.toml: keep: --keep: at least 1 second\n");
    EXPECT_EQ(refused("state = ''\n"), "octopair: c.toml: state: --state: must not be empty\n");
    EXPECT_EQ(refused("tokens = \"\"\n"), "octopair: c.toml: tokens: --tokens: must not be empty\n");
    EXPECT_EQ(refused("quiet = 1\n"), "octopair: c.toml: quiet: --quiet: '1' is neither true nor false\n");
    EXPECT_EQ(refused("grace = 1\nlog = 'x'\n").find("octopair: c.toml: log: --log: 'x' is not a valid value"), 0u);
}

/// Lines that are nearly right.
TEST_F(ServeOptions, LinesInAnotherFormAreRefused) {
    const std::string shape = "a line must be NAME = VALUE, or begin with #",
                      word = "a value must be one word, or in quotes";
    const std::string missing = "a value is missing", open = "a quote is not closed";
    for (const auto& [line, why] : std::vector<std::pair<std::string, std::string>>{
             {"[limits]", shape},
             {"[]", shape},
             {"[default]", shape},
             {"[limits", shape},
             {"= 5", shape},
             {"quiet", shape},
             {"max-jobs 5", shape},
             {"max-jobs: 5", shape},
             {"max_jobs = 5", shape},
             {"Max-Jobs = 5", shape},
             {"; a comment", shape},
             {"// a comment", shape},
             {"\"max-jobs\" = 5", shape},
             {"\xEF\xBB\xBFmax-jobs = 5", shape},
             {"''", shape},
             {"max-jobs =", missing},
             {"max-jobs = # 5", missing},
             {"max-jobs = [5]", missing},
             {"max-jobs = {a = 5}", missing},
             {"max-jobs = = 5", missing},
             {"max-jobs = 5#6", word},
             {"max-jobs = 5 6", word},
             {"max-jobs = 5, 6", word},
             {"max-jobs = 5;", word},
             {"max-jobs = 5 = 6", word},
             {"tokens = \"a\"b", word},
             {"tokens = a\"b\"", word},
             {"tokens = \"\"\"a\"\"\"", word},
             {"tokens = \"a\" \"b\"", word},
             {"tokens = 'a\rb'", "a carriage return must be at the end of a line"},
             {"# quiet = true\rmax-jobs = 5", "a carriage return must be at the end of a line"},
             {"tokens = \"a", open},
             {"tokens = 'a\"", open},
             {"tokens = \"a\\x62\"", "a value with a backslash must be in single quotes"}}) {
        EXPECT_EQ(refused("# right\n" + line + "\n"), "octopair: c.toml: line 2: " + why + "\n") << line;
    }
    write_file(file("c.toml"),
               "\r\n  threads=1 #one\r\n\tquiet = true  # no log\r\n max-memory\t= '2G'\ngrace = \"3\"");
    EXPECT_EQ(served("--config c.toml --listen unix:socket").status, 0) << content("log");
    EXPECT_EQ(content("log"), "");
}

TEST_F(ServeOptions, MissingFileIsNamed) {
    const Outcome outcome = run("serve --config none.toml --listen unix:socket");
    EXPECT_EQ(outcome.status, 4);
    EXPECT_EQ(outcome.err.find("octopair: none.toml: cannot open"), 0u) << outcome.err;
}

TEST_F(ServeOptions, CommandLineComesFirst) {
    write_file(file("c.toml"), "listen = \"0.0.0.0:0\"\nmax-memory = \"2G\"\nthreads = 1\nquiet = true\n");
    EXPECT_EQ(run("serve --config c.toml").status, 2);
    EXPECT_EQ(served("--config c.toml --listen unix:socket").status, 0) << content("log");
    EXPECT_EQ(content("log"), "");
    EXPECT_EQ(served("--config c.toml --listen unix:socket --max-memory wrong").status, 2);
}

TEST_F(ServeOptions, ExampleConfigurationIsAccepted) {
    const Outcome outcome = served("--config " OCTOPAIR_SOURCE "/packaging/serve.toml --listen unix:socket");
    EXPECT_EQ(outcome.status, 0) << content("log");
    EXPECT_TRUE(has_text(content("log"), "started"));
}

TEST_F(ServeOptions, BytesHaveSuffixes) {
    for (const std::string bytes : {"0", "65536", "64K", "1M", "4G", "16T"}) {
        EXPECT_EQ(served("--listen unix:socket --threads 1 --max-memory " + bytes).status, 0) << bytes;
    }
    for (const std::string bytes : {"''", "K", "-1", "4g", "4GB", "1.5G", "99999999999999T", "0x10"}) {
        EXPECT_EQ(run("serve --listen unix:socket --max-memory " + bytes).status, 2) << bytes;
    }
}

TEST_F(ServeOptions, OpenAddressesAreRefused) {
    const Outcome outcome = run("serve --listen 0.0.0.0:0");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(
        outcome.err,
        "octopair: 0.0.0.0:0: other machines can reach it; that needs TLS (a certificate and its key), and tokens or "
        "an authority for client certificates\n");
    EXPECT_EQ(run("serve --listen unix:socket --metrics 0.0.0.0:0").status, 2);
}

TEST_F(ServeOptions, WhatDoesNotFitIsRefused) {
    for (const std::string arguments :
         {"", "--listen nowhere", "--listen unix:socket --engine unix:other",
          "--listen unix:socket --engine local --workers 2", "--listen unix:socket --rank-timeout 5",
          "--listen unix:socket --tls-key key.pem", "--listen unix:socket --log xml",
          "--listen unix:socket --log-level loud", "--listen unix:socket --token abc"}) {
        EXPECT_EQ(run("serve " + arguments).status, 2) << arguments;
    }
}

}  // namespace
}  // namespace octopair::test
