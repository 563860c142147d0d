// Tests `octopair detect --events`: events equal the differences between the results of detect on consecutive frames.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/program.hpp"
#include "samples/scenes.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

using Rows = std::vector<double>;  // six numbers per box, for any number of frames

/// Returns the lines after the header, as numbers.
std::vector<std::vector<std::uint32_t>> csv_rows(const std::string& text) {
    std::vector<std::vector<std::uint32_t>> rows;
    std::istringstream lines(text);
    std::string line, field;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        auto& row = rows.emplace_back();
        for (std::istringstream fields(line); std::getline(fields, field, ',');) {
            row.push_back(std::uint32_t(std::stoul(field)));
        }
    }
    return rows;
}

/// Computes the expected output of --events from detect's output for the same scene.
std::string expected_events(const std::string& detected, std::uint32_t frames) {
    std::map<std::uint32_t, std::set<std::pair<std::uint32_t, std::uint32_t>>> pairs;
    for (const auto& row : csv_rows(detected)) pairs[row[0]].insert({row[1], row[2]});
    std::ostringstream text;
    text << "frame,event,a,b\n";
    for (std::uint32_t f = 0; f < frames; ++f) {
        const auto& now = pairs[f];
        const auto& before = f == 0 ? decltype(now){} : pairs[f - 1];
        for (const auto& [a, b] : before) {
            if (!now.contains({a, b})) text << f << ",end," << a << ',' << b << '\n';
        }
        for (const auto& [a, b] : now) {
            if (!before.contains({a, b})) text << f << ",begin," << a << ',' << b << '\n';
        }
    }
    return text.str();
}

class Events : public ProgramTest {
protected:
    static constexpr std::uint32_t frames = 6;

    template <typename Real>
    void save(const std::string& name, const std::vector<std::uint64_t>& shape, const Rows& rows) const {
        const auto type = sizeof(Real) == 4 ? io::NpyType::float32 : io::NpyType::float64;
        write_file(file(name), npy_of(type, shape, std::vector<Real>(rows.begin(), rows.end())));
    }

    /// Returns six frames of objects that move from one scene of a kind to another. Between the frames, few
    /// objects move, then none, then half, then most of them back, then all.
    static Rows moving_rows(std::string_view kind, std::uint64_t objects, std::uint64_t seed) {
        const auto from = samples::make_scene(kind, objects, seed), to = samples::make_scene(kind, objects, seed + 1);
        const std::uint64_t every[frames] = {0, 50, 50, 2, 40, 1};  // every n-th object has moved; 0: no object
        Rows rows;
        for (const std::uint64_t step : every) {
            for (std::size_t i = 0; i < objects; ++i) {
                const Box3f& box = step != 0 && i % step == 0 ? to[i] : from[i];
                rows.insert(rows.end(), box.min, box.min + 3);
                rows.insert(rows.end(), box.max, box.max + 3);
            }
        }
        return rows;
    }

    /// Compares detect --events with the expected events: on one and two threads, in a file, and from a server.
    void compare(const std::string& arguments) const {
        const Outcome plain = run("detect " + arguments + " --quiet");
        ASSERT_EQ(plain.status, 0) << plain.err;
        const std::string expected = expected_events(plain.out, frames);
        EXPECT_GT(expected.size(), 100u) << arguments << ": too few events to compare";
        for (const std::string threads : {" --threads 1", " --threads 2"}) {
            const Outcome outcome = run("detect " + arguments + " --events --quiet" + threads);
            EXPECT_EQ(outcome.status, 0) << outcome.err;
            EXPECT_EQ(outcome.err, "");
            EXPECT_TRUE(same_sequence(outcome.out, expected)) << arguments << threads;
        }
        ASSERT_EQ(run("detect " + arguments + " --events --quiet --output e.csv").status, 0);
        EXPECT_TRUE(same_sequence(content("e.csv"), expected)) << arguments;
#ifdef OCTOPAIR_WITH_SERVICE
        const Outcome served =
            shell("\"$P\" serve --listen unix:s 2>serve.log & server=$!; \"$P\" detect " + arguments +
                  " --events --quiet --engine unix:s; status=$?; kill -INT $server; wait $server; (exit $status)");
        EXPECT_EQ(served.status, 0) << served.err;
        EXPECT_TRUE(same_sequence(served.out, expected)) << arguments << ", by a server";
#endif
    }

    /// Saves three frames of three unit boxes: first 0 and 1 overlap, then 1 and 2, then none.
    void save_three() const {
        std::vector<float> rows;
        for (const auto& places : {std::vector<float>{0, 0.5, 9}, {0, 8.5, 9}, {0, 3, 6}}) {
            for (const float value : rows_of(places)) rows.push_back(value);
        }
        write_file(file("m.npy"), npy_of(io::NpyType::float32, {3, 3, 6}, rows));
    }
};

TEST_F(Events, RowsOfEachFormat) {
    save_three();
    const std::string csv = "frame,event,a,b\n0,begin,0,1\n1,end,0,1\n1,begin,1,2\n2,end,1,2\n";
    EXPECT_EQ(run("detect m.npy --events --quiet").out, csv) << "in each frame, end events precede begin events";
    EXPECT_EQ(run("detect m.npy --events --order ascending --stage pairs --engine local --quiet").out, csv);
    ASSERT_EQ(run("detect m.npy --events --output e.csv && \"$P\" detect m.npy --events --output e.jsonl").status, 0);
    EXPECT_EQ(content("e.csv"), csv);
    EXPECT_EQ(content("e.jsonl"),
              "{\"frame\":0,\"event\":\"begin\",\"a\":0,\"b\":1}\n{\"frame\":1,\"event\":\"end\",\"a\":0,\"b\":1}\n"
              "{\"frame\":1,\"event\":\"begin\",\"a\":1,\"b\":2}\n{\"frame\":2,\"event\":\"end\",\"a\":1,\"b\":2}\n");
}

TEST_F(Events, AreTheDifferenceOfFramesOnEveryKind) {
    for (const std::string_view kind : samples::scene_kinds()) {
        save<float>("m.npy", {frames, 200, 6}, moving_rows(kind, 200, 5));
        compare("m.npy --margin 0.01");
    }
}

TEST_F(Events, OfAGeneratedScene) {
    ASSERT_EQ(run("generate brownian --objects 5000 --frames 6 --seed 2 --output m.npy --quiet").status, 0);
    compare("m.npy");
    compare("m.npy --margin 0.004");
}

TEST_F(Events, MarginPaddingAndPrecision) {
    Rows rows = moving_rows("uniform", 1000, 7);
    save<float>("m.npy", {frames, 1000, 6}, rows);
    for (double& number : rows) number += 1e-9;  // float32 does not hold such numbers
    save<double>("wide.npy", {frames, 1000, 6}, rows);
    Rows paddings(2000);
    for (std::size_t i = 0; i < paddings.size(); ++i) paddings[i] = double(i % 7) * 0.002;
    save<double>("pad.npy", {1000}, {paddings.begin(), paddings.begin() + 1000});
    save<double>("pad2.npy", {2000}, paddings);
    for (const std::string scene : {"m.npy", "wide.npy"}) {
        for (const std::string options :
             {"", " --margin 0.01", " --padding pad.npy", " --padding pad.npy --margin 0.01"})
            compare(scene + options);
    }
    compare("m.npy wide.npy --padding pad2.npy");
}

TEST_F(Events, BetweenTwoSets) {
    save<float>("a.npy", {frames, 700, 6}, moving_rows("mixed", 700, 1));
    save<float>("b.npy", {frames, 300, 6}, moving_rows("dense", 300, 9));
    save<double>("wide.npy", {frames, 300, 6}, moving_rows("uniform", 300, 3));
    ASSERT_EQ(run("generate dense --objects 400 --seed 3 --output still.npy --quiet").status, 0);
    save<double>("pad.npy", {700}, Rows(700, 0.01));
    save<double>("pad2.npy", {1000}, Rows(1000, 0.01));
    compare("a.npy --against b.npy");
    compare("b.npy --against a.npy");
    compare("a.npy --against wide.npy");
    compare("wide.npy --against still.npy --margin 0.02");
    compare("still.npy --against a.npy");
    compare("a.npy --against a.npy --margin 0.001");
    compare("a.npy --against b.npy --padding pad.npy");
    compare("a.npy --against b.npy --padding pad2.npy --margin 0.01");
    compare("a.npy b.npy --against still.npy");
}

TEST_F(Events, ASceneThatStandsStillHasOneFrame) {
    save_boxes("a.npy", {0, 0.5, 9});
    save_boxes("b.npy", {9.5});
    save_boxes("none.npy", {});
    EXPECT_EQ(run("detect a.npy --events --quiet").out, "frame,event,a,b\n0,begin,0,1\n");
    EXPECT_EQ(run("detect a.npy b.npy --events --quiet").out, "frame,event,a,b\n0,begin,0,1\n0,begin,2,3\n");
    EXPECT_EQ(run("detect a.npy --against b.npy --events --quiet").out, "frame,event,a,b\n0,begin,2,0\n");
    EXPECT_EQ(run("detect none.npy --events --quiet").out, "frame,event,a,b\n");
    EXPECT_EQ(run("detect a.npy --against none.npy --events --quiet").out, "frame,event,a,b\n");
    EXPECT_EQ(run("detect none.npy --against a.npy --events --quiet").out, "frame,event,a,b\n");
    write_file(file("noframes.npy"), npy_of<float>(io::NpyType::float32, {0, 3, 6}, {}));
    EXPECT_EQ(run("detect noframes.npy --events --quiet").out, "frame,event,a,b\n");
}

TEST_F(Events, StatsAndSummary) {
    save_three();
    const Outcome outcome = run("detect m.npy --events --stats s.json --threads 2");
    EXPECT_TRUE(has_text(outcome.err, "pairs       2\nevents      2 began, 2 ended\n"));
    const auto stats = nlohmann::json::parse(content("s.json"));
    for (const auto& [key, value] : std::map<std::string, int>{
             {"objects", 3}, {"frames", 3}, {"pairs", 2}, {"began", 2}, {"ended", 2}, {"threads", 2}}) {
        EXPECT_EQ(stats[key], value) << key;
    }
    EXPECT_EQ(stats["truncated"], false);
    double parts = 0;
    for (const char* key : {"read", "detect", "write"}) parts += stats["seconds"][key].get<double>();
    EXPECT_LE(parts, stats["seconds"]["total"].get<double>() + 1e-9);
    EXPECT_FALSE(stats["seconds"].contains("scan"));
}

TEST_F(Events, LimitIsOfRows) {
    save_three();
    const std::vector<std::string> rows = {"0,begin,0,1\n", "1,end,0,1\n", "1,begin,1,2\n", "2,end,1,2\n"};
    std::string expected = "frame,event,a,b\n";
    for (std::size_t limit = 0; limit <= 5; ++limit) {
        const Outcome outcome = run("detect m.npy --events --stats s.json --limit " + std::to_string(limit));
        EXPECT_EQ(outcome.out, expected);
        const auto stats = nlohmann::json::parse(content("s.json"));
        EXPECT_EQ(stats["truncated"], limit < 4);
        EXPECT_EQ(stats["began"].get<std::size_t>() + stats["ended"].get<std::size_t>(),
                  std::min<std::size_t>(limit, 4));
        EXPECT_EQ(outcome.err.find("more exist") != std::string::npos, limit < 4);
        if (limit < rows.size()) expected += rows[limit];
    }
}

TEST_F(Events, FailsOnCollisionWhenAsked) {
    save_three();
    save_boxes("apart.npy", {0, 2});
    EXPECT_EQ(run("detect m.npy --events --fail-on-collision --quiet").status, 1);
    EXPECT_EQ(run("detect m.npy --events --fail-on-collision --limit 0 --quiet").status, 1);
    EXPECT_EQ(run("detect apart.npy --events --fail-on-collision --quiet").status, 0);
}

TEST_F(Events, ABadFrameLeavesNothingOfThoseBefore) {
    Rows rows = moving_rows("coincident", 800, 1);  // 319,600 pairs: more than a buffer holds
    rows[(4 * 800 + 17) * 6 + 1] = NAN;
    save<float>("m.npy", {frames, 800, 6}, rows);
    save_boxes("good.npy", {0, 1});
    write_file(file("e.csv"), "old");
    const std::string message = "octopair: m.npy: frame 4: object 17: min y is nan, not a finite number\n";
    for (const std::string arguments : {"m.npy", "m.npy --output e.csv", "m.npy --against good.npy",
                                        "good.npy --against m.npy", "m.npy m.npy --output new.jsonl"}) {
        const Outcome outcome = run("detect " + arguments + " --events");
        EXPECT_EQ(outcome.status, 3) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_EQ(outcome.err, message) << arguments;
    }
    EXPECT_EQ(content("e.csv"), "old");
    EXPECT_EQ(directory_.names(), (std::vector<std::string>{"e.csv", "good.npy", "m.npy"}));
    save<float>("inverted.npy", {1, 6}, {0, 2, 0, 1, 1, 1});
    EXPECT_EQ(run("detect inverted.npy --events").err, "octopair: inverted.npy: object 0: min y 2 is above max y 1\n");
}

TEST_F(Events, FilesThatDoNotGoTogether) {
    save_three();
    save_boxes("still.npy", {0, 1});
    save<float>("two.npy", {2, 1, 6}, Rows(12, 0));
    save<float>("pad.npy", {2}, {0, 0});
    for (const std::string arguments :
         {"m.npy still.npy", "still.npy m.npy", "m.npy two.npy", "m.npy --against two.npy", "m.npy --padding pad.npy",
          "m.npy --padding still.npy"}) {
        const Outcome plain = run("detect " + arguments);
        const Outcome events = run("detect " + arguments + " --events");
        EXPECT_EQ(events.status, 3) << arguments;
        EXPECT_EQ(events.err, plain.err) << arguments;
    }
    EXPECT_EQ(run("detect m.npy missing.npy --events").status, 4);
    EXPECT_EQ(run("detect m.npy --events --output none/e.csv").status, 4);
    EXPECT_EQ(run("detect m.npy --events >/dev/full").status, 4);
}

TEST_F(Events, Interrupted) {
    ASSERT_EQ(run("generate brownian --objects 100000 --frames 40 --output m.npy --quiet").status, 0);
    write_file(file("e.csv"), "old");
    const Outcome outcome = shell(
        "\"$P\" detect m.npy --events --margin 0.02 --output e.csv --threads 1 & child=$!; "
        "hears $child; sleep 0.2; kill -INT $child; wait $child");
    EXPECT_EQ(outcome.status, 130);
    EXPECT_EQ(outcome.err, "octopair: interrupted\n");
    EXPECT_EQ(content("e.csv"), "old");
    EXPECT_EQ(directory_.names(), (std::vector<std::string>{"e.csv", "m.npy"}));
}

TEST_F(Events, InterruptedWhileAPipeIsFull) {
    ASSERT_EQ(run("generate coincident --objects 1000 --output m.npy --quiet").status, 0);
    // The reader never reads, so the pipe fills and the program blocks in a write. Only SIGINT can end the program.
    const Outcome outcome = shell(
        "mkfifo pipe; sh -c 'exec <pipe; while [ ! -e status ]; do sleep 0.05; done' & "
        "\"$P\" detect m.npy --events >pipe & child=$!; hears $child; sleep 0.2; kill -INT $child; wait $child; "
        "status=$?; echo >status; wait; exit $status");
    EXPECT_EQ(outcome.status, 130) << outcome.err;
}

#ifndef OCTOPAIR_TEST_SANITIZED
TEST_F(Events, MemoryHoldsNoMoreThanFramesTwoByTwo) {
    ASSERT_EQ(run("generate brownian --objects 10000 --frames 400 --output m.npy --quiet").status, 0);
    for (const std::string output : {"", " --output e.csv"}) {
        ASSERT_EQ(run("detect m.npy --events --threads 2 --quiet --stats s.json" + output).status, 0);
        const auto stats = nlohmann::json::parse(content("s.json"));
        EXPECT_LT(stats["peak_rss_bytes"].get<std::uint64_t>(), std::filesystem::file_size(file("m.npy")) / 2);
    }
}
#endif

}  // namespace
}  // namespace octopair::test
