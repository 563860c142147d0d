// Server benchmark: overhead of remote calls, and behaviour with many clients.
//
//     octopair_service [--rounds N] [--quick] [--json FILE]
//
// A server of this build listens on a Unix socket, with two threads. Its clients are in this process, on the same
// machine. The exit status is 1 if pairs differ from the local engine's, or if a job is wrong or lost.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/files/atomic_file.hpp"
#include "machine/machine.hpp"
#include "machine/median.hpp"
#include "service/measurements.hpp"
#include "service/server_process.hpp"

namespace {

using namespace octopair;
using namespace octopair::bench;
using Json = nlohmann::ordered_json;

struct Request {
    unsigned rounds = 21;
    bool quick = false;
    std::string json;
};

Json against_local(const ServerProcess& served, const Request& request) {
    Json rows = Json::array();
    for (const std::uint64_t objects : {1'000'000u, 100'000u, 10'000u, 1'000u}) {
        for (const Order order : {Order::octal, Order::ascending}) {
            const unsigned rounds = objects > 10'000 ? request.rounds : 10 * request.rounds;
            const AgainstLocal run = measure_against_local(served.address(), objects, order, rounds);
            const double local = median(run.local), remote = median(run.remote);
            const std::string order_name = order == Order::octal ? "octal" : "ascending";
            fmt::print("{:>9} objects, {:<9}  local {:8.3f} ms, remote {:8.3f} ms, ratio {:.2f}; submit {:.3f} ms{}\n",
                       objects, order_name, local * 1e3, remote * 1e3, remote / local, median(run.submit) * 1e3,
                       run.same ? "" : "  DIFFERS");
            std::fflush(stdout);
            rows.push_back({{"objects", objects},
                            {"order", order_name},
                            {"local_seconds", local},
                            {"remote_seconds", remote},
                            {"submit_seconds", median(run.submit)},
                            {"same", run.same}});
        }
    }
    return rows;
}

Json crowd(const ServerProcess& served, const Crowd& what) {
    const Crowd run = measure_crowd(served.address(), what);
    const double rate = double(run.jobs) / run.seconds;
    const double middle = quantile(run.latencies, 0.5), slow = quantile(run.latencies, 0.99);
    fmt::print(
        "{:>3} clients, {} jobs of {} objects  {:.0f} jobs/s, median {:.3f} ms, 99% {:.3f} ms, {} wrong or lost\n",
        run.clients, run.jobs, run.objects, rate, middle * 1e3, slow * 1e3, run.wrong);
    std::fflush(stdout);
    return {{"clients", run.clients},
            {"jobs", run.jobs},
            {"objects", run.objects},
            {"jobs_per_second", rate},
            {"median_seconds", middle},
            {"p99_seconds", slow},
            {"slowest_seconds", run.latencies.empty() ? 0 : run.latencies.back()},
            {"wrong", run.wrong}};
}

Json crowds(const ServerProcess& served, const Request& request) {
    Json rows = Json::array();
    for (Crowd what : {Crowd{.clients = 8, .objects = 1000, .jobs = 40'000},
                       Crowd{.clients = 100, .objects = 10'000, .jobs = 5000}}) {
        if (request.quick) what.jobs /= 5;
        rows.push_back(crowd(served, what));
    }
    return rows;
}

Json scene(const ServerProcess& served, const Request& request) {
    const SceneAgainstLocal run = measure_scene(served.address(), 100'000, 1000, 20 * request.rounds);
    const double local = median(run.local), remote = median(run.remote), above = median(run.above);
    fmt::print(
        "scene of {}, {} moved per frame, {:.0f} changes  local {:.3f} ms, remote {:.3f} ms, difference {:.3f} ms; "
        "opening {:.1f} ms{}\n",
        run.objects, run.moved, run.changes, local * 1e3, remote * 1e3, above * 1e3, run.opening * 1e3,
        run.same ? "" : "  DIFFERS");
    return {{"objects", run.objects},         {"moved", run.moved},       {"changes", run.changes},
            {"local_seconds", local},         {"remote_seconds", remote}, {"above_seconds", above},
            {"opening_seconds", run.opening}, {"same", run.same}};
}

/// Returns whether the server's pairs were always those of the local engine, and no job was wrong or lost.
bool all_right(const Json& results) {
    const auto same = [](const Json& row) { return row.at("same").get<bool>(); };
    const auto none_wrong = [](const Json& row) { return row.at("wrong") == 0; };
    return std::ranges::all_of(results.at("against_local"), same) && same(results.at("scene")) &&
           std::ranges::all_of(results.at("crowds"), none_wrong);
}

int run(const Request& request) {
    std::optional<io::AtomicFile> file;
    if (!request.json.empty()) file.emplace(request.json);
    const ServerProcess served(OCTOPAIR_PROGRAM, {"--threads", "2"});
    Json all = machine_json();
    all["rounds"] = request.rounds;
    all["against_local"] = against_local(served, request);
    all["crowds"] = crowds(served, request);
    all["scene"] = scene(served, request);
    if (file) {
        file->write(all.dump(1) + '\n');
        file->commit();
    }
    return all_right(all) ? 0 : 1;
}

}  // namespace

int main(int count, char** words) {
    Request request;
    CLI::App app("Measures octopair's server: the overhead of remote calls, and many concurrent clients.");
    const CLI::Option* const rounds = app.add_option(
        "--rounds", request.rounds, "rounds for large jobs; small jobs get ten times as many (default 21)");
    app.add_flag("--quick", request.quick, "use a third of the rounds and a fifth of the jobs");
    app.add_option("--json", request.json);
    CLI11_PARSE(app, count, words);
    if (request.quick && rounds->count() == 0) request.rounds /= 3;
    try {
        return run(request);
    } catch (const std::exception& error) {
        std::cerr << "octopair_service: " << error.what() << '\n';
        return 3;
    }
}
