// Tests `octopair detect` on valid input.
#include <nlohmann/json.hpp>
#include <numeric>
#include <regex>

#include "cli/program.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

class Detect : public ProgramTest {};

std::vector<std::uint32_t> npy_pairs(const std::string& content) {
    std::vector<std::uint32_t> values((content.size() - 128) / 4);
    if (!values.empty()) std::memcpy(values.data(), content.data() + 128, values.size() * 4);
    return values;
}

TEST_F(Detect, WritesCsvToStandardOutput) {
    save_boxes("a.npy", {0, 5, 0.5, 5.5, 1});
    const Outcome outcome = run("detect a.npy");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "a,b\n0,2\n0,4\n1,3\n2,4\n");
    EXPECT_TRUE(has_text(outcome.err, "objects     5\n"));
    EXPECT_TRUE(has_text(outcome.err, "pairs       4\n"));
    EXPECT_EQ(outcome.err.find('\r'), std::string::npos) << "progress is shown only on a terminal";
    const Outcome quiet = run("detect a.npy --quiet");
    EXPECT_EQ(quiet.out, outcome.out);
    EXPECT_EQ(quiet.err, "");
}

TEST_F(Detect, WritesEachFormat) {
    save_boxes("a.npy", {0, 0.5, 9});
    EXPECT_EQ(run("detect a.npy --output p.npy && \"$P\" detect a.npy --output p.csv && "
                  "\"$P\" detect a.npy --output p.jsonl")
                  .status,
              0);
    EXPECT_EQ(npy_pairs(content("p.npy")), (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(content("p.csv"), "a,b\n0,1\n");
    EXPECT_EQ(content("p.jsonl"), "{\"a\":0,\"b\":1}\n");
}

TEST_F(Detect, ReadsCsvAndSpheres) {
    write_file(file("a.csv"), "x,y,z,X,Y,Z\r\n0,0,0,1,1,1\r\n1,1,1,2,2,2\r\n1.0000000000000002,1,1,2,2,2\r\n");
    EXPECT_EQ(run("detect a.csv").out, "a,b\n0,1\n1,2\n") << "float64 boxes are compared in float64";
    write_file(file("s.npy"), npy_of<float>(io::NpyType::float32, {3, 4}, {0, 0, 0, 1, 2, 0, 0, 1, 4.001f, 0, 0, 1}));
    EXPECT_EQ(run("detect s.npy").out, "a,b\n0,1\n");
}

TEST_F(Detect, SeveralInputsAreOneSet) {
    save_boxes("a.npy", {0, 10});
    write_file(file("b.csv"), "0.5,0,0,0.75,1,1\n");
    save_boxes("c.npy", {10.5});
    EXPECT_EQ(run("detect a.npy b.csv c.npy").out, "a,b\n0,2\n1,3\n");
}

TEST_F(Detect, AgainstAnotherSet) {
    save_boxes("a.npy", {0, 0.5, 10});
    save_boxes("b.npy", {10.5, 0.25});
    EXPECT_EQ(run("detect a.npy --against b.npy").out, "a,b\n0,1\n1,1\n2,0\n");
    EXPECT_EQ(run("detect a.npy --against b.npy --count-only --quiet").out, "3\n");
}

TEST_F(Detect, MarginAndPadding) {
    save_boxes("a.npy", {0, 2, 4.5});
    EXPECT_EQ(run("detect a.npy").out, "a,b\n");
    EXPECT_EQ(run("detect a.npy --margin 1").out, "a,b\n0,1\n");
    EXPECT_EQ(run("detect a.npy --margin 1.5").out, "a,b\n0,1\n1,2\n");
    write_file(file("pad.npy"), npy_of<double>(io::NpyType::float64, {3}, {0, 0.5, 1}));
    EXPECT_EQ(run("detect a.npy --padding pad.npy").out, "a,b\n1,2\n");
    EXPECT_EQ(run("detect a.npy --padding pad.npy --margin 0.5").out, "a,b\n0,1\n1,2\n");
    save_boxes("b.npy", {2});
    write_file(file("pad4.npy"), npy_of<float>(io::NpyType::float32, {4}, {0.5, 0, 1, 0.5}));
    EXPECT_EQ(run("detect a.npy --against b.npy --padding pad4.npy").out, "a,b\n0,0\n1,0\n2,0\n");
    EXPECT_EQ(run("detect a.npy --against b.npy --padding pad.npy").out, "a,b\n1,0\n");
}

TEST_F(Detect, LimitSaysWhetherMoreExist) {
    save_boxes("a.npy", {0, 0, 0});
    for (const auto& [limit, truncated] : {std::pair{2, true}, {3, false}, {4, false}, {0, true}}) {
        const std::string options = " --limit " + std::to_string(limit) + " --stats s.json";
        for (const std::string what : {" --output p.csv", " --count-only"}) {
            const Outcome outcome = run("detect a.npy" + what + options);
            const auto stats = nlohmann::json::parse(content("s.json"));
            EXPECT_EQ(stats["pairs"], std::min(limit, 3)) << limit << what;
            EXPECT_EQ(stats["truncated"], truncated) << limit << what;
            EXPECT_EQ(outcome.err.find("more exist") != std::string::npos, truncated);
        }
    }
    EXPECT_EQ(run("detect a.npy --limit 2").out, "a,b\n0,1\n0,2\n");
}

TEST_F(Detect, OrdersHoldTheSamePairs) {
    ASSERT_EQ(run("generate dense --objects 3000 --seed 7 --output a.npy --quiet").status, 0);
    const Outcome sorted = shell("\"$P\" detect a.npy --order octal --quiet | tail -n +2 | sort -t, -k1n -k2n");
    const Outcome ascending = shell("\"$P\" detect a.npy --order ascending --quiet | tail -n +2");
    EXPECT_GT(ascending.out.size(), 1000u);
    EXPECT_TRUE(same_sequence(sorted.out, ascending.out));
    const Outcome one = shell("\"$P\" detect a.npy --threads 1 --quiet | tail -n +2");
    EXPECT_TRUE(same_sequence(one.out, ascending.out));
}

TEST_F(Detect, FailsOnCollisionWhenAsked) {
    save_boxes("apart.npy", {0, 2});
    save_boxes("together.npy", {0, 1});
    EXPECT_EQ(run("detect apart.npy --fail-on-collision").status, 0);
    EXPECT_EQ(run("detect together.npy").status, 0);
    const Outcome found = run("detect together.npy --fail-on-collision");
    EXPECT_EQ(found.status, 1);
    EXPECT_EQ(found.out, "a,b\n0,1\n");
    EXPECT_EQ(run("detect together.npy --fail-on-collision --count-only").status, 1);
    EXPECT_EQ(run("detect together.npy --fail-on-collision --limit 0").status, 1);
}

TEST_F(Detect, AnInputWithoutObjectsIsAWarningOrAnError) {
    save_boxes("empty.npy", {});
    save_boxes("full.npy", {0, 2});
    const Outcome found = run("detect full.npy --against empty.npy --count-only --stats s.json");
    EXPECT_EQ(found.status, 0);
    EXPECT_TRUE(has_text(found.err, "warning     empty.npy: has no object\n"));
    EXPECT_TRUE(has_text(content("s.json"), "empty.npy: has no object"));
    for (const char* inputs : {"full.npy empty.npy", "full.npy --against empty.npy", "empty.npy --events"}) {
        const Outcome refused = run("detect " + std::string(inputs) + " --fail-on-collision");
        EXPECT_EQ(refused.status, 3) << inputs;
        EXPECT_TRUE(has_text(refused.err, "empty.npy: has no object, so --fail-on-collision"));
    }
}

TEST_F(Detect, StatsHoldEveryKey) {
    save_boxes("a.npy", {0, 0.5, 9});
    ASSERT_EQ(run("detect a.npy --output p.npy --stats s.json --threads 2 --quiet").status, 0);
    const auto stats = nlohmann::json::parse(content("s.json"));
    EXPECT_EQ(stats["objects"], 3);
    EXPECT_EQ(stats["pairs"], 1);
    EXPECT_EQ(stats["truncated"], false);
    EXPECT_EQ(stats["engine"], "local");
    EXPECT_EQ(stats["threads"], 2);
    EXPECT_EQ(stats["workers"], 0);
    EXPECT_GE(stats["entries"].get<int>(), 3);
    EXPECT_GT(stats["peak_rss_bytes"].get<std::uint64_t>(), 1'000'000u);
    double parts = 0;
    for (const char* key : {"read", "detect", "write"}) parts += stats["seconds"][key].get<double>();
    EXPECT_LE(parts, stats["seconds"]["total"].get<double>() + 1e-9);
    for (const char* key : {"encode", "count", "scatter", "scan", "filter"})
        EXPECT_GE(stats["seconds"][key].get<double>(), 0);
}

TEST_F(Detect, MovingScenes) {
    std::vector<float> rows = rows_of({0, 0.5, 9});
    for (const float value : rows_of({0, 8.5, 9})) rows.push_back(value);
    for (const float value : rows_of({0, 3, 6})) rows.push_back(value);
    write_file(file("m.npy"), npy_of(io::NpyType::float32, {3, 3, 6}, rows));
    EXPECT_EQ(run("detect m.npy --quiet").out, "frame,a,b\n0,0,1\n1,1,2\n");
    EXPECT_EQ(run("detect m.npy --count-only --quiet").out, "2\n");
    EXPECT_EQ(run("detect m.npy --limit 1 --quiet").out, "frame,a,b\n0,0,1\n");
    ASSERT_EQ(run("detect m.npy --output p.npy").status, 0);
    EXPECT_EQ(directory_.names(), (std::vector<std::string>{"m.npy", "p.000000.npy", "p.000001.npy", "p.000002.npy"}));
    EXPECT_EQ(npy_pairs(content("p.000001.npy")), (std::vector<std::uint32_t>{1, 2}));
    EXPECT_EQ(npy_pairs(content("p.000002.npy")), std::vector<std::uint32_t>{});
    save_boxes("still.npy", {3.5});
    EXPECT_EQ(run("detect m.npy --against still.npy --quiet").out, "frame,a,b\n2,1,0\n");
    EXPECT_EQ(run("detect m.npy still.npy --quiet").status, 3);
}

TEST_F(Detect, EmptyScenes) {
    save_boxes("none.npy", {});
    save_boxes("one.npy", {0});
    for (const std::string arguments : {"none.npy", "one.npy", "none.npy none.npy", "one.npy --against none.npy"}) {
        const Outcome outcome = run("detect " + arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "a,b\n");
    }
    write_file(file("noframes.npy"), npy_of<float>(io::NpyType::float32, {0, 3, 6}, {}));
    EXPECT_EQ(run("detect noframes.npy --quiet").out, "frame,a,b\n");
}

/// Returns the number of the last digit's units in the times of a line "NAME TOTAL = NAME TIME + ... + other TIME" of a summary: first
/// the total, then the parts. Returns nothing if there is no such line.
std::vector<long> times_of(const std::string& summary, const std::string& line) {
    std::smatch found;
    if (!std::regex_search(summary, found, std::regex("\n" + line + " +([^\n]* = [^\n]* other [^\n]*)\n"))) return {};
    const std::string text = found[1];
    const std::regex time("([0-9]+)\\.([0-9]+) (ms|s)\\b");
    std::vector<long> times;
    for (std::sregex_iterator each(text.begin(), text.end(), time), end; each != end; ++each) {
        times.push_back(std::stol((*each)[1].str() + (*each)[2].str()));
    }
    return times;
}

TEST_F(Detect, TimesOfASummaryAddUp) {
    ASSERT_EQ(run("generate uniform --objects 20000 -o a.npy").status, 0);
    ASSERT_EQ(run("generate brownian --objects 500 --frames 7 -o moving.npy").status, 0);
    write_file(file("meshes.obj"),
               "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nv 0 0 -1\nv 1 0 1\nv 0 1 1\nf 4 5 6\n");
    std::vector<std::string> runs = {
        "a.npy -o p.npy",      "a.npy --count-only --threads 1", "a.npy --verify --order octal -o p.npy",
        "moving.npy -o m.csv", "moving.npy --events -o e.csv",   "a.npy --against a.npy -o p.csv"};
#ifdef OCTOPAIR_WITH_PIPELINE
    runs.insert(runs.end(), {"meshes.obj --stage features --verify -o c.jsonl", "a.npy --exclude rules.json -o p.csv"});
    write_file(file("rules.json"), R"({"exclude": []})");
#endif
#ifdef OCTOPAIR_WITH_PROCESSES
    runs.insert(runs.end(), {"a.npy --engine processes -o p.npy", "moving.npy --engine processes --events -o e.csv"});
#endif
    for (const std::string& arguments : runs) {
        const Outcome outcome = run("detect " + arguments + " --stats s.json");
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        const auto seconds = nlohmann::json::parse(content("s.json"))["seconds"];
        const double unit = seconds["total"] < 10 ? 1e5 : 1e3;
        for (const auto& [line, name] : {std::pair("time", "total"), std::pair("detect", "detect")}) {
            const std::vector<long> times = times_of(outcome.err, line);
            if (times.empty() && has_text(arguments, "--events") && line == std::string("detect")) continue;
            ASSERT_GE(times.size(), 4u) << arguments << "\n" << outcome.err;
            EXPECT_EQ(times[0], long(double(seconds[name]) * unit)) << outcome.err;
            EXPECT_EQ(std::accumulate(times.begin() + 1, times.end(), 0L), times[0]) << outcome.err;
        }
    }
}

}  // namespace
}  // namespace octopair::test
