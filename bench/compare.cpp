// Compares octopair with its peers, its baselines and the limits of the hardware.
//
//     octopair_compare [--scene KIND...] [--input FILE...] [--objects N...] [--threads K] [--rounds R] [--seconds S]
//                      [--least R] [--only NAME...] [--first] [--json FILE]
//
// Each row shows the median. All contenders take turns (peers/comparison.hpp). Google Benchmark would run each
// contender to its end before the next. Standard error shows the progress. A contender that finds other pairs than the
// first contender is marked, and the exit status is 1. With `--first`, only the first run of each contender is timed.
// Combine `--first` with `--only NAME` to time a fresh engine in a fresh process.
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/files/atomic_file.hpp"
#include "machine/machine.hpp"
#include "peers/comparison.hpp"

namespace {

using namespace octopair;
using namespace octopair::bench;

struct Request {
    SceneRequest scenes{{}, {1'000'000}, {}};
    ComparisonPlan plan;
    std::string json;
};

std::string remark(const Row& row) { return row.agrees ? "" : fmt::format("  DIFFERS: {} pairs", row.found.pairs); }

void print(const Scene& scene, const std::vector<Row>& rows, unsigned threads) {
    fmt::print("{}, {} objects, {} thread(s), {} pairs\n", scene.name, scene.boxes.size(), threads,
               rows.front().found.pairs);
    const double ours = rows.front().median();
    for (const Row& row : rows) {
        switch (row.state) {
            case RowState::measured:
                fmt::print("  {:<20} {:>10.2f} ms {:>8.2f} x {}\n", row.contender, row.median() * 1e3,
                           row.median() / ours, remark(row));
                break;
            case RowState::out_of_memory:
                fmt::print("  {:<20} out of memory\n", row.contender);
                break;
            case RowState::left_out:
                fmt::print("  {:<20} left out above {} objects\n", row.contender, row.max_objects);
                break;
        }
    }
    std::fflush(stdout);
}

nlohmann::ordered_json row_json(const Row& row) {
    if (row.state == RowState::left_out) {
        return {{"contender", row.contender}, {"left_out_above", row.max_objects}};
    }
    return {{"contender", row.contender},
            {"out_of_memory", row.state == RowState::out_of_memory},
            {"median_seconds", row.median()},
            {"seconds", row.seconds},
            {"first_seconds", row.first_seconds},
            {"pairs", row.found.pairs},
            {"hash", fmt::format("{:016x}", row.found.hash)},
            {"agrees", row.agrees}};
}

nlohmann::ordered_json scene_json(const Scene& scene, const std::vector<Row>& rows, unsigned threads) {
    nlohmann::ordered_json list = nlohmann::json::array();
    for (const Row& row : rows) list.push_back(row_json(row));
    return {{"scene", scene.name}, {"objects", scene.boxes.size()}, {"threads", threads}, {"rows", list}};
}

/// Limits memory to three quarters of the machine's memory. A contender that needs more fails and does not stall the
/// machine.
void limit_memory() {
    const rlim_t bytes = rlim_t(::sysconf(_SC_PHYS_PAGES)) * rlim_t(::sysconf(_SC_PAGESIZE)) / 4 * 3;
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_AS, &limit);
}

void save(io::AtomicFile& file, const nlohmann::ordered_json& results) {
    nlohmann::ordered_json all = machine_json();
    all["results"] = results;
    file.write(all.dump(1) + '\n');
    file.commit();
}

int run(const Request& request) {
    std::optional<io::AtomicFile> json;
    if (!request.json.empty()) json.emplace(request.json);
    nlohmann::ordered_json results = nlohmann::json::array();
    bool agree = true;
    for_each_scene(request.scenes, [&](const Scene& scene) {
        const auto tell = [&](std::string_view what) {
            fmt::print(stderr, "{}, {} objects: {}\n", scene.name, scene.boxes.size(), what);
        };
        const std::vector<Row> rows = compare(scene, request.plan, tell);
        if (rows.empty()) throw std::runtime_error("no contender matches --only and --threads");
        print(scene, rows, request.plan.threads);
        results.push_back(scene_json(scene, rows, request.plan.threads));
        agree = agree && std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.agrees; });
    });
    if (json) save(*json, results);
    return agree ? 0 : 1;
}

}  // namespace

int main(int count, char** words) {
    Request request;
    CLI::App app("Compares octopair with its peers, its baselines and the limits of the hardware.");
    app.add_option("--scene", request.scenes.kinds,
                   "scene kinds of octopair generate (default without --input: six kinds)");
    app.add_option("--input", request.scenes.inputs,
                   "files of boxes, spheres or triangles; several files also form a joint scene");
    app.add_option("--objects", request.scenes.objects,
                   "numbers of objects of each kind, measured one after the other (default 1000000)");
    app.add_option("--threads", request.plan.threads,
                   "threads; above 1, contenders with one thread are left out (default 1)");
    app.add_option("--rounds", request.plan.rounds);
    app.add_option("--seconds", request.plan.max_seconds, "time limit of a contender per scene (default 20)");
    app.add_option("--least", request.plan.min_rounds,
                   "minimum number of rounds, even beyond the time limit (default 3)");
    app.add_option("--only", request.plan.only, "only these contenders, even above their limit of objects");
    app.add_flag("--first", request.plan.first, "time only the first run of each contender");
    app.add_option("--json", request.json);
    CLI11_PARSE(app, count, words);
    if (request.scenes.kinds.empty() && request.scenes.inputs.empty()) {
        request.scenes.kinds = {"uniform", "dense", "mixed", "clustered", "flat", "world10"};
    }
    limit_memory();
    try {
        return run(request);
    } catch (const std::exception& error) {
        std::cerr << "octopair_compare: " << error.what() << '\n';
        return 3;
    }
}
