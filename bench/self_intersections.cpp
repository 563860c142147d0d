// Self-intersections of a closed mesh: octopair's pipeline, from vertices to pairs, and CGAL's self_intersections.
//
//     octopair_self_intersections [--triangles N] [--threads K] [--rounds N] [--seed S] [--json FILE]
//
// All contenders take turns, round by round; the first round is not counted. octopair starts from vertices and
// triangles, like a user. Its time includes making triangles and boxes. If another contender finds other pairs, the
// exit status is 1.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "io/files/atomic_file.hpp"
#include "machine/machine.hpp"
#include "machine/median.hpp"
#include "octopair/filters.hpp"
#include "octopair/octopair.hpp"
#include "self_intersections/cgal.hpp"
#include "self_intersections/surface.hpp"

namespace {

using namespace octopair;

struct Request {
    std::uint32_t triangles = 1'000'000;
    std::uint32_t seed = 1;
    unsigned threads = 2;
    unsigned rounds = 5;
    std::string json;
};

struct Contender {
    std::string name;
    std::function<std::vector<Pair>()> run;
    std::vector<Pair> pairs = {};
    std::vector<double> seconds = {};

    double median() const { return bench::median(seconds); }
};

/// Returns triangles with the positions of their corners. Several threads write them into uninitialised memory.
std::unique_ptr<Triangle3d[]> triangles_of(const shape::Mesh& mesh, unsigned threads) {
    const std::size_t count = mesh.triangles.size();
    auto triangles = std::make_unique_for_overwrite<Triangle3d[]>(count);
    const auto make_part = [&](std::size_t part) {
        for (std::size_t i = count * part / threads; i < count * (part + 1) / threads; ++i) {
            for (std::size_t k = 0; k < 3; ++k) triangles[i][k] = mesh.vertices[mesh.triangles[i][k]];
        }
    };
    std::vector<std::jthread> others;
    for (std::size_t part = 1; part < threads; ++part) others.emplace_back(make_part, part);
    make_part(0);
    others.clear();
    return triangles;
}

std::vector<Pair> self_intersections(const shape::Mesh& mesh, Engine& engine, unsigned threads) {
    const auto memory = triangles_of(mesh, threads);
    const std::span<const Triangle3d> triangles(memory.get(), mesh.triangles.size());
    auto boxes = engine.allocate_boxes(triangles.size());
    boxes_of(triangles, boxes.boxes(), threads);
    Pipeline pipeline(threads);
    pipeline.add(make_triangle_filter({triangles}, {.threads = threads}));
    Options options;
    options.order = Order::octal;
    std::vector<Pair> pairs;
    pipeline.run(
        engine, {std::span(std::as_const(boxes).boxes())},
        [&](const Batch& batch) { pairs.insert(pairs.end(), batch.pairs().begin(), batch.pairs().end()); }, options);
    return pairs;
}

void run_round(std::vector<Contender>& contenders, bool counts) {
    for (Contender& contender : contenders) {
        const auto begin = std::chrono::steady_clock::now();
        contender.pairs = contender.run();
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        if (counts) contender.seconds.push_back(taken.count());
    }
}

void sort_pairs(std::vector<Pair>& pairs) {
    for (Pair& pair : pairs) pair = {std::min(pair.a, pair.b), std::max(pair.a, pair.b)};
    std::sort(pairs.begin(), pairs.end());
}

nlohmann::ordered_json results_json(const Request& request, const std::vector<Contender>& contenders) {
    auto rows = nlohmann::ordered_json::array();
    for (const Contender& contender : contenders) {
        rows.push_back({{"name", contender.name},
                        {"median_seconds", contender.median()},
                        {"seconds", contender.seconds},
                        {"agrees", contender.pairs == contenders.front().pairs}});
    }
    return {{"machine", bench::machine_json()},
            {"triangles", request.triangles},
            {"threads", request.threads},
            {"pairs", contenders.front().pairs.size()},
            {"contenders", rows}};
}

int compare(const Request& request) {
    const shape::Mesh mesh = bench::make_surface(request.triangles, request.seed);
    const auto engine = make_local_engine(request.threads);
    const bench::CgalSelfIntersections cgal(mesh);
    std::vector<Contender> contenders;
    contenders.push_back({"octopair", [&] { return self_intersections(mesh, *engine, request.threads); }});
    contenders.push_back({"CGAL, sequential", [&] { return cgal.run(1); }});
    if (request.threads > 1) contenders.push_back({"CGAL, parallel", [&] { return cgal.run(request.threads); }});
    for (unsigned round = 0; round <= request.rounds; ++round) run_round(contenders, round > 0);
    for (Contender& contender : contenders) sort_pairs(contender.pairs);

    const Contender& ours = contenders.front();
    fmt::print("{} triangles, {} pairs, {} threads, {} rounds\n", mesh.triangles.size(), ours.pairs.size(),
               request.threads, request.rounds);
    bool all_agree = true;
    for (const Contender& contender : contenders) {
        const bool agrees = contender.pairs == ours.pairs;
        all_agree &= agrees;
        fmt::print("  {:<20} {:>10.1f} ms {:>8.2f}{}\n", contender.name, contender.median() * 1e3,
                   contender.median() / ours.median(),
                   agrees ? "" : fmt::format("  DIFFERS: {} pairs", contender.pairs.size()));
    }
    if (!request.json.empty()) {
        io::AtomicFile file(request.json);
        file.write(results_json(request, contenders).dump(2) + '\n');
        file.commit();
    }
    return all_agree ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    Request request;
    CLI::App app("Compares octopair with CGAL on self-intersections of a closed mesh.");
    app.add_option("--triangles", request.triangles)->check(CLI::Range(24, 100'000'000));
    app.add_option("--threads", request.threads)->check(CLI::Range(1, 1024));
    app.add_option("--rounds", request.rounds)->check(CLI::Range(1, 1000));
    app.add_option("--seed", request.seed);
    app.add_option("--json", request.json, "write the results to this file as JSON");
    CLI11_PARSE(app, argc, argv);
    return compare(request);
}
