// Tests `octopair detect --engine`: worker processes write the same bytes as threads, even if workers fail.
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "cli/program.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

#ifdef OCTOPAIR_WITH_PROCESSES

constexpr const char* on_workers = " --engine processes --workers ";

class Engines : public ProgramTest {
protected:
    void generate(const std::string& kind, int objects, const std::string& name, const std::string& more = "") const {
        const Outcome outcome = run("generate " + kind + " --objects " + std::to_string(objects) +
                                    " --seed 5 --output " + name + " --quiet" + more);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    }

    /// Runs detect on threads and on 1 to 3 workers.
    void compare(const std::string& arguments) const {
        const Outcome local = run("detect " + arguments + " --quiet");
        ASSERT_EQ(local.status, 0) << arguments << ": " << local.err;
        EXPECT_GT(local.out.size(), 2u) << arguments << ": nothing to compare";
        for (const std::string workers : {"1", "2", "3"}) {
            const Outcome outcome = run("detect " + arguments + " --quiet" + on_workers + workers);
            EXPECT_EQ(outcome.status, 0) << arguments << ": " << outcome.err;
            EXPECT_EQ(outcome.err, "") << arguments;
            EXPECT_TRUE(same_sequence(outcome.out, local.out)) << arguments << ", workers: " << workers;
        }
    }

    /// Compares the output for a file, and for all files of a moving scene.
    void compare_files(const std::string& arguments, const std::string& name) const {
        const auto contents = [&](const std::string& options) {
            const Outcome outcome =
                run("detect " + arguments + " --quiet --output p/" + name + options + " && cat p/* && rm p/*");
            EXPECT_EQ(outcome.status, 0) << outcome.err;
            return outcome.out;
        };
        ASSERT_EQ(shell("mkdir -p p").status, 0);
        const std::string local = contents("");
        EXPECT_GT(local.size(), 100u);
        for (const std::string workers : {"1", "2", "3"}) {
            EXPECT_TRUE(same_sequence(contents(on_workers + workers), local))
                << arguments << ", " << name << ", " << workers;
        }
    }

    /// Functions of sh. `find_workers` waits for the workers of $child and sets $workers. `gone` waits until the
    /// workers end, or prints that a worker still runs.
    static constexpr const char* functions = R"(
        find_workers() {
            for i in $(seq 200); do
                workers=$(cat /proc/$child/task/*/children 2>/dev/null)
                [ -z "$workers" ] || return 0
                sleep 0.01
            done
            echo "no workers"
        }
        lives() { grep -q '^State:.[^XZ]' /proc/$1/status 2>/dev/null; }
        gone() {
            for worker in $workers; do
                for i in $(seq 30); do lives $worker || break; sleep 0.1; done
                ! lives $worker || echo "a worker still runs"
            done
        }
        )";
};

TEST_F(Engines, SameBytesOfEachFormatAndOrder) {
    generate("dense", 20'000, "a.npy");
    for (const std::string name : {"p.npy", "p.csv", "p.jsonl"}) {
        compare_files("a.npy", name);
        compare_files("a.npy --order octal", name);
    }
    compare("a.npy");
    compare("a.npy --order octal");
    compare("a.npy --count-only");
}

TEST_F(Engines, SameBytesWithEveryOption) {
    generate("mixed", 20'000, "a.npy");
    generate("clustered", 15'000, "b.npy");
    std::vector<double> padding(35'000);
    for (std::size_t i = 0; i < padding.size(); ++i) padding[i] = double(i % 7) * 1e-4;
    write_file(file("both.npy"), npy_of<double>(io::NpyType::float64, {35'000}, padding));
    for (const std::string order : {"", " --order octal"}) {
        compare("a.npy --margin 0.001" + order);
        compare("a.npy b.npy --padding both.npy" + order);
        compare("a.npy --against b.npy" + order);
        compare("a.npy --against b.npy --padding both.npy --margin 0.0005" + order);
        for (const std::string limit : {"1", "1000", "100000000"}) compare("a.npy --limit " + limit + order);
    }
    compare("a.npy --against b.npy --count-only --margin 0.001");
    compare("a.npy --limit 100 --count-only");
}

TEST_F(Engines, SameBytesOfMovingScenes) {
    generate("brownian", 9000, "m.npy", " --frames 4");
    generate("uniform", 5000, "still.npy");
    compare("m.npy");
    compare("m.npy --against still.npy --margin 0.003");
    compare("m.npy --limit 6000");
    compare("m.npy --count-only");
    compare_files("m.npy", "p.npy");
    compare_files("m.npy --order octal", "p.jsonl");
}

TEST_F(Engines, SameBytesOfSmallScenes) {
    save_boxes("none.npy", {});
    save_boxes("one.npy", {0});
    save_boxes("two.npy", {0, 0.5});
    for (const std::string arguments :
         {"two.npy", "none.npy --count-only", "one.npy --count-only", "none.npy none.npy --count-only",
          "one.npy --against none.npy --count-only", "two.npy --against one.npy"}) {
        const Outcome local = run("detect " + arguments + " --quiet");
        const Outcome workers = run("detect " + arguments + " --quiet" + on_workers + "2");
        EXPECT_EQ(workers.status, 0) << workers.err;
        EXPECT_EQ(workers.out, local.out) << arguments;
    }
}

TEST_F(Engines, SameBytesOfAMeshScene) {
    if (run("info").out.find("Assimp") == std::string::npos) GTEST_SKIP() << "built without meshes";
    std::string mesh;
    for (int i = 0; i < 3000; ++i) {
        for (const char* corner : {" 0 0\n", " 1 0\n", " 0 1\n"}) mesh += "v " + std::to_string(i * 0.5) + corner;
        mesh += "f -3 -2 -1\n";
    }
    write_file(file("strip.obj"), mesh);
    write_file(file("cube.obj"), "o a\nv 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\no b\nv 1 0 0\nv 2 0 0\nv 1 1 1\nf 4 5 6\n");
    compare("strip.obj --objects triangle --margin 0.5");
    compare("cube.obj");
    compare("cube.obj --stage pairs");
}

TEST_F(Engines, StatsSayWhereItRan) {
    save_boxes("a.npy", {0, 0.5, 9});
    const Outcome outcome = run(std::string("detect a.npy --output p.npy --stats s.json") + on_workers + "3");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(has_text(outcome.err, " on 3 workers\n"));
    const auto stats = nlohmann::json::parse(content("s.json"));
    EXPECT_EQ(stats["engine"], "processes");
    EXPECT_EQ(stats["threads"], 0);
    EXPECT_EQ(stats["workers"], 3);
    EXPECT_EQ(stats["pairs"], 1);
    EXPECT_GE(stats["entries"].get<int>(), 3);
    EXPECT_TRUE(has_text(run("detect a.npy --engine processes --workers 1").err, " on 1 worker\n"));
    ASSERT_EQ(run("detect a.npy --engine processes --workers 0 --stats s.json --quiet").status, 0);
    EXPECT_GE(nlohmann::json::parse(content("s.json"))["workers"].get<int>(), 1) << "one worker per core";
    EXPECT_TRUE(has_text(run("info").out, "engines          local, processes"));
}

TEST_F(Engines, SameEvents) {
    generate("brownian", 5'000, "moving.npy", " --frames 6");
    generate("uniform", 3'000, "still.npy");
    for (const char* const more : {"", " --margin 0.01", " --limit 70", " --against still.npy"}) {
        compare(std::string("moving.npy --events") + more);
        compare(std::string("still.npy --events") + more);
    }
    compare_files("moving.npy --events", "e.jsonl");
    ASSERT_EQ(run("detect moving.npy --events --quiet --stats s.json --output e.csv" + (on_workers + std::string("2")))
                  .status,
              0);
    const auto stats = nlohmann::json::parse(content("s.json"));
    EXPECT_EQ(stats["engine"], "processes");
    ASSERT_EQ(run("detect moving.npy --events --quiet --stats t.json --output e.csv").status, 0);
    const auto expected = nlohmann::json::parse(content("t.json"));
    EXPECT_EQ(stats["pairs"], expected["pairs"]);
    EXPECT_EQ(stats["began"], expected["began"]);
    EXPECT_EQ(stats["ended"], expected["ended"]);
}

TEST_F(Engines, RefusesOptionsThatConflict) {
    save_boxes("a.npy", {0});
    for (const auto& [arguments, message] : std::map<std::string, std::string>{
             {"--engine processes --threads 2",
              "--threads: not with --engine processes; --workers sets the number of worker processes"},
             {"--workers 2", "--workers: only with --engine processes; the local engine has --threads"},
             {"--engine local --workers 2", "--workers: only with --engine processes; the local engine has --threads"},
             {"--engine processes --workers 257", "--workers: 257 is not in the range 0 to 256"},
             {"--engine processes --workers two", "--workers: 'two' is not a whole number from 0 to 256"},
#ifdef OCTOPAIR_WITH_MPI
             {"--engine mpi --workers 2", "--workers: not with --engine mpi; mpirun -n sets the number of ranks"},
             {"--engine threads", "--engine: 'threads' is not a valid value; valid values: local, processes, mpi"}
#else
             {"--engine mpi", "--engine: this octopair was built without 'mpi'; it has: local, processes"},
             {"--engine threads", "--engine: 'threads' is not a valid value; valid values: local, processes"}
#endif
         }) {
        const Outcome outcome = run("detect a.npy " + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.err, "octopair: " + message + "\n");
    }
}

TEST_F(Engines, ReportsBadBoxes) {
    auto rows = rows_of(std::vector<float>(30'000, 1));
    rows[6 * 29'000 + 4] = -7;
    write_file(file("bad.npy"), npy_of(io::NpyType::float32, {30'000, 6}, rows));
    const Outcome outcome = run(std::string("detect bad.npy --output p.npy") + on_workers + "2");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.err, "octopair: bad.npy: object 29000: min y 0 is above max y -7\n");
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"bad.npy"});
}

TEST_F(Engines, RefusesAnInvalidWorkerProgram) {
    save_boxes("a.npy", {0, 0.5});
    const Outcome missing = shell("OCTOPAIR_WORKER=/nonexistent \"$P\" detect a.npy --engine processes --output p.npy");
    EXPECT_EQ(missing.status, 6);
    EXPECT_EQ(missing.err, "octopair: cannot start the worker program /nonexistent: No such file or directory\n");
    const Outcome other = shell("OCTOPAIR_WORKER=/bin/false \"$P\" detect a.npy --engine processes --output p.npy");
    EXPECT_EQ(other.status, 6);
    EXPECT_TRUE(has_text(other.err, "/bin/false"));
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"a.npy"});
}

/// The program is killed while its workers are stopped, under a subreaper in its own session: only there the system does not
/// continue and end such processes by itself.
TEST_F(Engines, StoppedWorkersEndWithTheProgram) {
    generate("coincident", 60'000, "big.npy");
    const Outcome outcome = shell(
        "/usr/bin/python3 - \"$P\" <<'END'\n"
        "import ctypes, os, signal, subprocess, sys, time\n"
        "ctypes.CDLL(None).prctl(36, 1, 0, 0, 0)  # PR_SET_CHILD_SUBREAPER\n"
        "program = subprocess.Popen([sys.argv[1], 'detect', 'big.npy', '--count-only', '--engine', 'processes',\n"
        "                            '--workers', '2', '--quiet'])\n"
        "children = []\n"
        "while len(children) < 2:\n"
        "    time.sleep(0.05)\n"
        "    tasks = os.listdir(f'/proc/{program.pid}/task')\n"
        "    children = sum((open(f'/proc/{program.pid}/task/{t}/children').read().split() for t in tasks), [])\n"
        "time.sleep(0.3)\n"
        "for child in children: os.kill(int(child), signal.SIGSTOP)\n"
        "program.kill()\n"
        "program.wait()\n"
        "ended = 0\n"
        "for i in range(100):\n"
        "    time.sleep(0.05)\n"
        "    try:\n"
        "        while os.waitpid(-1, os.WNOHANG)[0]: ended += 1\n"
        "    except ChildProcessError: break\n"
        "for child in children:\n"
        "    try: os.kill(int(child), signal.SIGKILL)\n"
        "    except ProcessLookupError: pass\n"
        "print(ended, 'of', len(children))\n"
        "END\n");
    EXPECT_EQ(outcome.out, "2 of 2\n") << outcome.err;
}

TEST_F(Engines, AnInterruptLeavesTheOldFileAndNoWorkers) {
    generate("coincident", 60'000, "big.npy");  // 1,799,970,000 pairs: seconds of work
    write_file(file("p.npy"), "old");
    for (const auto& [signal, status, words] :
         {std::tuple<std::string, int, std::string>("INT", 130, "interrupted"), {"TERM", 143, "terminated"}}) {
        const Outcome outcome =
            shell(functions + ("\"$P\" detect big.npy --output p.npy --engine processes --workers 2 & child=$!; "
                               "find_workers; sleep 0.3; kill -" +
                               signal + " $child; wait $child; status=$?; gone; exit $status"));
        EXPECT_EQ(outcome.status, status);
        EXPECT_EQ(outcome.err, "octopair: " + words + "\n");
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(content("p.npy"), "old");
        EXPECT_EQ(directory_.names(), (std::vector<std::string>{"big.npy", "p.npy"}));
    }
}

TEST_F(Engines, AWorkerThatIsKilledOrStoppedIsReplaced) {
    generate("coincident", 5000, "crowd.npy");  // 12,497,500 pairs
    generate("uniform", 400'000, "uniform.npy");
    unsigned hits = 0;
    for (const std::string arguments : {"crowd.npy", "crowd.npy --order octal", "uniform.npy"}) {
        ASSERT_EQ(run("detect " + arguments + " --output local.npy --quiet").status, 0);
        for (const std::string signal : {"KILL", "STOP"}) {
            const Outcome outcome =
                shell(functions + ("\"$P\" detect " + arguments + " --output p.npy --quiet" + on_workers +
                                   "2 & child=$!; find_workers; sleep 0.03; kill -" + signal +
                                   " ${workers%% *} 2>/dev/null && echo hit; wait $child"));
            EXPECT_EQ(outcome.status, 0) << outcome.err;
            EXPECT_EQ(outcome.err, "");
            EXPECT_EQ(shell("cmp local.npy p.npy").status, 0) << arguments << ", " << signal;
            hits += outcome.out == "hit\n" ? 1 : 0;
        }
    }
    EXPECT_GE(hits, 1u);
}

TEST_F(Engines, WorkersEndWithAProgramThatIsKilled) {
    generate("coincident", 60'000, "big.npy");
    const Outcome outcome = shell(functions + std::string("\"$P\" detect big.npy --count-only --quiet") + on_workers +
                                  "2 & child=$!; find_workers; sleep 0.2; kill -KILL $child; wait $child; gone");
    EXPECT_EQ(outcome.out, "");
}

TEST_F(Engines, FilesThatMayNotBeLarge) {
    generate("uniform", 1000, "a.npy");
    const Outcome outcome = shell(std::string("ulimit -f 1000; \"$P\" detect a.npy --output p.npy") + on_workers + "2");
    EXPECT_EQ(outcome.status, 5);
    EXPECT_TRUE(outcome.err.starts_with("octopair: shared memory: ")) << outcome.err;
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"a.npy"});
}

#else

class Engines : public ProgramTest {};

TEST_F(Engines, WhatWasNotBuiltIsSaid) {
    save_boxes("a.npy", {0});
    const Outcome outcome = run("detect a.npy --engine processes");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "octopair: --engine: this octopair was built without 'processes'; it has: local\n");
    EXPECT_TRUE(has_text(run("info").out, "engines          local\n"));
}

#endif

}  // namespace
}  // namespace octopair::test
