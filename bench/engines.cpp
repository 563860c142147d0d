// Compares engines on equal scenes: threads and worker processes.
//
//     octopair_engines [--workers K] [--rounds N] [--quick] [--json FILE]
//
// All engines take turns in one process, round by round, and keep their lists (engines/contest.hpp). Each row shows the
// median, the first call and the start of the engine. First, the program measures the memory of each engine over all
// its processes (engines/memory.hpp). An engine that finds other pairs than the first engine is marked, and the exit
// status is 1. `--quick` uses a tenth of the objects in large scenes, and a third of the rounds.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "engines/contenders.hpp"
#include "engines/contest.hpp"
#include "engines/memory.hpp"
#include "io/files/atomic_file.hpp"
#include "machine/machine.hpp"

namespace {

using namespace octopair;
using namespace octopair::bench;
using Json = nlohmann::ordered_json;

struct Request {
    unsigned workers = 2;  // worker processes, and threads of the local engine
    unsigned rounds = 21;  // rounds for large scenes
    bool quick = false;
    std::string json;
};

std::string order_name(Order order) { return order == Order::octal ? "octal" : "ascending"; }

/// Reduces the number of objects for a quick trial of the program.
void shrink(std::uint64_t& objects) {
    if (objects > 100'000) objects /= 10;
}

void print(const Contest& contest, const std::vector<Entrant>& entrants) {
    fmt::print("{}, {} objects, {}, {} pairs, {} rounds\n", contest.kind, contest.objects, order_name(contest.order),
               entrants.front().pairs, contest.rounds);
    fmt::print("  {:<28} {:>10} {:>10} {:>10} {:>10}\n", "milliseconds", "median", "/ first", "first call", "start");
    const double first = entrants.front().median();
    for (const Entrant& entrant : entrants) {
        fmt::print("  {:<28} {:>10.3f} {:>10.2f} {:>10.3f} {:>10.3f}{}\n", entrant.engine, entrant.median() * 1e3,
                   entrant.median() / first, entrant.first_seconds * 1e3, entrant.start_seconds * 1e3,
                   entrant.agrees ? "" : fmt::format("  DIFFERS: {} pairs", entrant.pairs));
    }
    std::fflush(stdout);
}

Json contest_json(const Contest& contest, const std::vector<Entrant>& entrants) {
    Json rows = Json::array();
    for (const Entrant& entrant : entrants) {
        rows.push_back({{"engine", entrant.engine},
                        {"median_seconds", entrant.median()},
                        {"first_seconds", entrant.first_seconds},
                        {"start_seconds", entrant.start_seconds},
                        {"agrees", entrant.agrees},
                        {"seconds", entrant.seconds}});
    }
    return {{"scene", contest.kind},
            {"objects", contest.objects},
            {"order", order_name(contest.order)},
            {"pairs", entrants.front().pairs},
            {"rows", rows}};
}

Json run_memory(const Request& request) {
    Json rows = Json::array();
    fmt::print("bytes per object beyond boxes and pairs, sum over all processes\n");
    fmt::print("  {:<28} {:<9} {:<10} {:>8} {:>8} {:>8} {:>8}\n", "", "scene", "order", "pairs/n", "idle MB", "kept",
               "highest");
    for (EngineMemoryCase which : engine_memory_cases()) {
        if (request.quick) shrink(which.objects);
        const EngineMemoryUse use = measure_memory(which, request.workers);
        if (!use.known()) {
            fmt::print("  not available: this system does not report shared pages\n");
            return rows;
        }
        const double n = double(which.objects);
        const bool bounded = which.engine == processes_name;
        fmt::print("  {:<28} {:<9} {:<10} {:>8.2f} {:>8.1f} {:>8.1f} {:>8.1f}{}\n", which.engine, which.kind,
                   order_name(which.order), double(use.pairs) / n, use.idle / 1e6, use.kept / n, use.highest / n,
                   bounded && use.highest > max_engine_bytes * n ? "  MISSED" : "");
        std::fflush(stdout);
        rows.push_back({{"engine", which.engine},
                        {"scene", which.kind},
                        {"objects", which.objects},
                        {"order", order_name(which.order)},
                        {"pairs", use.pairs},
                        {"idle_bytes", use.idle},
                        {"kept_bytes", use.kept},
                        {"highest_bytes", use.highest}});
        if (bounded) rows.back()["max_bytes"] = max_engine_bytes * n;
    }
    return rows;
}

int run(const Request& request) {
    std::optional<io::AtomicFile> file;
    if (!request.json.empty()) file.emplace(request.json);
    Json all = machine_json();
    all["workers"] = request.workers;
    all["rounds"] = request.rounds;
    // Memory comes first: the measurement forks while this process has one thread and no memory of other measurements.
    all["memory"] = run_memory(request);
    Json results = Json::array();
    bool agree = true;
    for (Contest contest : contests(request.rounds)) {
        if (request.quick) shrink(contest.objects);
        const std::vector<Entrant> entrants = hold(contest, request.workers);
        print(contest, entrants);
        results.push_back(contest_json(contest, entrants));
        agree = agree && std::all_of(entrants.begin(), entrants.end(), [](const Entrant& e) { return e.agrees; });
    }
    all["results"] = results;
    if (file) {
        file->write(all.dump(1) + '\n');
        file->commit();
    }
    return agree ? 0 : 1;
}

}  // namespace

int main(int count, char** words) {
    Request request;
    CLI::App app("Compares octopair's engines on equal scenes.");
    app.add_option("--workers", request.workers, "worker processes, and threads of the local engine (default 2)")
        ->check(CLI::Range(1, 256));
    const CLI::Option* const rounds = app.add_option(
        "--rounds", request.rounds, "rounds for large scenes; small scenes get ten times as many (default 21)");
    app.add_flag("--quick", request.quick, "use a tenth of the objects in large scenes, and a third of the rounds");
    app.add_option("--json", request.json);
    CLI11_PARSE(app, count, words);
    if (request.quick && rounds->count() == 0) request.rounds /= 3;
    try {
        return run(request);
    } catch (const std::exception& error) {
        std::cerr << "octopair_engines: " << error.what() << '\n';
        return 3;
    }
}
