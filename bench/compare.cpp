// octopair against its peers, its baselines and the limits of the hardware, side by side.
//
//     octopair_compare [--scene KIND...] [--input FILE...] [--objects N] [--threads K] [--rounds R] [--only NAME...]
//                      [--json FILE]
//
// All contenders of a scene take turns, round by round, so that what else the machine does meets them alike; a row tells
// the median. (Google Benchmark runs one contender after the other, so this is not built on it.) The first run of each is
// not counted; `--first` times nothing but that, for a fresh engine in a fresh process. Who finds other pairs than the
// first contender is marked, and makes the exit status 1. Slow contenders run less often: until they have had their share
// of time, but at least 3 times.
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "io/scene_reader.hpp"
#include "machine/machine.hpp"
#include "peers/contender.hpp"
#include "samples/scenes.hpp"

namespace {

using namespace octopair;
using namespace octopair::bench;

struct Request {
    std::vector<std::string> scenes;
    std::vector<std::string> inputs;
    std::vector<std::string> only;
    std::uint64_t objects = 1'000'000;
    unsigned threads = 1;
    unsigned rounds = 7;
    double most_seconds = 20;  // of one contender on one scene
    bool first = false;
    std::string json;
};

struct Scene {
    std::string name;
    std::vector<Box3f> boxes;
};

struct Row {
    std::string contender;
    bool limit = false;
    double first_seconds = 0;
    std::vector<double> seconds;  // in the order of the rounds
    Found found;
    bool agrees = true;
    bool failed = false;  // ran out of memory: some algorithms hold all candidates

    double median() const {
        std::vector<double> sorted = seconds.empty() ? std::vector{first_seconds} : seconds;
        std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
        return sorted[sorted.size() / 2];
    }
};

struct Runner {
    Row row;
    std::unique_ptr<Contender> contender;
    double spent = 0;
};

double timed_run(Contender& contender, std::span<const Box3f> boxes) {
    const auto begin = std::chrono::steady_clock::now();
    contender.run(boxes);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::vector<Box3f> boxes_of(const io::LoadedScene& scene) {
    std::vector<Box3f> boxes;
    const auto copy = [&](const auto& from) {
        for (const auto& box : from.span()) {
            Box3f& to = boxes.emplace_back();
            for (int axis = 0; axis < 3; ++axis) {
                to.min[axis] = float(box.min[axis]);
                to.max[axis] = float(box.max[axis]);
            }
        }
    };
    std::visit(copy, scene.boxes);
    return boxes;
}

/// Scenes side by side along x, a tenth of the largest apart.
Scene side_by_side(const std::vector<Scene>& scenes) {
    Scene all{"all inputs side by side", {}};
    float at = 0;
    for (const Scene& scene : scenes) {
        float first = scene.boxes[0].min[0], last = scene.boxes[0].max[0];
        for (const Box3f& box : scene.boxes) {
            first = std::min(first, box.min[0]);
            last = std::max(last, box.max[0]);
        }
        for (Box3f box : scene.boxes) {
            box.min[0] += at - first;
            box.max[0] += at - first;
            all.boxes.push_back(box);
        }
        at += (last - first) * 1.1f;
    }
    return all;
}

std::vector<Scene> scenes_of(const Request& request) {
    std::vector<Scene> scenes;
    for (const std::string& kind : request.scenes) {
        scenes.push_back({kind, samples::make_scene(kind, request.objects, 1)});
    }
    std::vector<Scene> real;
    for (const std::string& path : request.inputs) {
        real.push_back(
            {path.substr(path.find_last_of('/') + 1), boxes_of(io::read_scene(path, io::MeshObjects::triangle))});
    }
    scenes.insert(scenes.end(), real.begin(), real.end());
    if (real.size() > 1) scenes.push_back(side_by_side(real));
    return scenes;
}

bool asked(const Request& request, const ContenderKind& kind) {
    if (request.threads > 1 && !kind.threads) return false;
    return request.only.empty() || std::find(request.only.begin(), request.only.end(), kind.name) != request.only.end();
}

std::vector<Row> compare(const Scene& scene, const Request& request) {
    std::vector<Runner> runners;
    for (const ContenderKind& kind : contender_kinds()) {
        if (!asked(request, kind)) continue;
        Runner& runner = runners.emplace_back();
        runner.contender = kind.make(request.threads);
        runner.row.contender = kind.name;
        runner.row.limit = kind.limit;
        try {
            runner.spent = runner.row.first_seconds = timed_run(*runner.contender, scene.boxes);
        } catch (const std::bad_alloc&) {
            runner.contender.reset();
            runner.row.failed = true;
            continue;
        }
        runner.row.found = runner.contender->found();
        const Found& expected = runners.front().row.found;
        runner.row.agrees =
            runner.row.found == expected || (runner.row.found.hash == 0 && runner.row.found.pairs == expected.pairs);
    }
    for (unsigned round = 0; round < request.rounds && !request.first; ++round) {
        for (Runner& runner : runners) {
            if (runner.row.failed || (round >= 3 && runner.spent > request.most_seconds)) continue;
            runner.row.seconds.push_back(timed_run(*runner.contender, scene.boxes));
            runner.spent += runner.row.seconds.back();
        }
    }
    std::vector<Row> rows;
    for (Runner& runner : runners) rows.push_back(std::move(runner.row));
    return rows;
}

void print(const Scene& scene, const std::vector<Row>& rows, const Request& request) {
    fmt::print("{}, {} objects, {} thread(s), {} pairs\n", scene.name, scene.boxes.size(), request.threads,
               rows.front().found.pairs);
    const double ours = rows.front().median();
    for (const Row& row : rows) {
        if (row.failed) {
            fmt::print("  {:<20} out of memory\n", row.contender);
            continue;
        }
        fmt::print("  {:<20} {:>10.2f} ms {:>8.2f} x {}\n", row.contender, row.median() * 1e3, row.median() / ours,
                   row.limit || row.agrees ? "" : fmt::format("  DIFFERS: {} pairs", row.found.pairs));
    }
    std::fflush(stdout);
}

nlohmann::ordered_json json_of(const Scene& scene, const std::vector<Row>& rows, const Request& request) {
    nlohmann::ordered_json list = nlohmann::json::array();
    for (const Row& row : rows) {
        list.push_back({{"contender", row.contender},
                        {"out_of_memory", row.failed},
                        {"median_seconds", row.median()},
                        {"seconds", row.seconds},
                        {"first_seconds", row.first_seconds},
                        {"pairs", row.found.pairs},
                        {"hash", fmt::format("{:016x}", row.found.hash)},
                        {"agrees", row.limit || row.agrees}});
    }
    return {{"scene", scene.name}, {"objects", scene.boxes.size()}, {"threads", request.threads}, {"rows", list}};
}

/// Three quarters of the machine's memory at most: what needs more fails, where it would else bring all to a halt.
void limit_memory() {
    const rlim_t bytes = rlim_t(::sysconf(_SC_PHYS_PAGES)) * rlim_t(::sysconf(_SC_PAGESIZE)) / 4 * 3;
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_AS, &limit);
}

int run(const Request& request) {
    nlohmann::ordered_json results = nlohmann::json::array();
    bool agree = true;
    for (const Scene& scene : scenes_of(request)) {
        const std::vector<Row> rows = compare(scene, request);
        if (rows.empty()) throw std::runtime_error("no such contender");
        print(scene, rows, request);
        results.push_back(json_of(scene, rows, request));
        for (const Row& row : rows) agree = agree && (row.limit || row.failed || row.agrees);
    }
    if (!request.json.empty()) {
        nlohmann::ordered_json all = machine_json();
        all["results"] = results;
        std::ofstream file(request.json);
        file << all.dump(1) << '\n';
        if (!file.flush()) throw std::runtime_error("cannot write " + request.json);
    }
    return agree ? 0 : 1;
}

}  // namespace

int main(int count, char** words) {
    Request request;
    CLI::App app("octopair against its peers, side by side");
    app.add_option("--scene", request.scenes, "kinds of scenes, as in octopair generate");
    app.add_option("--input", request.inputs, "files of boxes, spheres or triangles; several also side by side as one");
    app.add_option("--objects", request.objects, "of each scene");
    app.add_option("--threads", request.threads, "contenders that cannot use them are left out");
    app.add_option("--rounds", request.rounds);
    app.add_option("--seconds", request.most_seconds, "after which a contender rests, on one scene");
    app.add_option("--only", request.only, "contenders by name");
    app.add_flag("--first", request.first, "time the first run alone");
    app.add_option("--json", request.json);
    CLI11_PARSE(app, count, words);
    if (request.scenes.empty() && request.inputs.empty()) {
        request.scenes = {"uniform", "dense", "mixed", "clustered", "flat", "world10"};
    }
    limit_memory();
    try {
        return run(request);
    } catch (const std::exception& error) {
        std::cerr << "octopair_compare: " << error.what() << '\n';
        return 3;
    }
}
