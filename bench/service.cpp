// Server benchmark: overhead of remote calls, and behaviour with many clients.
//
//     octopair_service [--rounds N] [--quick] [--json FILE]
//
// A server of this build listens on a Unix socket, with two threads. Its clients are in this process, on the same
// machine.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
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

/// Aims, with the values reached.
class Aims {
public:
    /// Returns a remark for the line of the measurement; empty if the aim was reached.
    const char* at_most(const std::string& what, double bound, double reached) {
        return keep(what, true, bound, reached, reached <= bound);
    }
    const char* at_least(const std::string& what, double bound, double reached) {
        return keep(what, false, bound, reached, reached >= bound);
    }
    const Json& json() const { return rows_; }

private:
    const char* keep(const std::string& what, bool at_most, double bound, double reached, bool kept) {
        rows_.push_back({{"what", what}, {"at_most", at_most}, {"bound", bound}, {"reached", reached}, {"kept", kept}});
        return kept ? "" : "  MISSED";
    }

    Json rows_ = Json::array();
};

Json against_local(const ServerProcess& served, const Request& request, Aims& aims) {
    Json rows = Json::array();
    for (const std::uint64_t objects : {1'000'000u, 100'000u, 10'000u, 1'000u}) {
        for (const Order order : {Order::octal, Order::ascending}) {
            const unsigned rounds = objects > 10'000 ? request.rounds : 10 * request.rounds;
            const AgainstLocal run = measure_against_local(served.address(), objects, order, rounds);
            const double local = median(run.local), remote = median(run.remote);
            const std::string order_name = order == Order::octal ? "octal" : "ascending";
            const char* const verdict =
                objects == 1'000'000
                    ? aims.at_most("1,000,000 boxes, " + order_name + ": remote / local", 1.8, remote / local)
                    : "";
            fmt::print(
                "{:>9} objects, {:<9}  local {:8.3f} ms, remote {:8.3f} ms, ratio {:.2f}; submit {:.3f} ms{}{}\n",
                objects, order_name, local * 1e3, remote * 1e3, remote / local, median(run.submit) * 1e3,
                run.same ? "" : "  DIFFERS", verdict);
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

Json crowd(const ServerProcess& served, const Crowd& what, Aims& aims) {
    const Crowd run = measure_crowd(served.address(), what);
    const double rate = double(run.jobs) / run.seconds;
    const double middle = quantile(run.latencies, 0.5), slow = quantile(run.latencies, 0.99);
    const std::string name = fmt::format("{} clients, {} boxes a job: ", run.clients, run.objects);
    std::string verdict = aims.at_most(name + "jobs wrong or lost", 0, double(run.wrong));
    if (what.objects == 1000) {
        verdict += aims.at_least(name + "jobs a second", 4000, rate);
        verdict += aims.at_most(name + "slowest of 99 in 100, ms", 20, slow * 1e3);
    } else {
        verdict += aims.at_most(name + "slowest of 99 in 100 / median", 10, slow / middle);
    }
    fmt::print(
        "{:>3} clients, {} jobs of {} objects  {:.0f} jobs/s, median {:.3f} ms, 99% {:.3f} ms, {} wrong or lost{}\n",
        run.clients, run.jobs, run.objects, rate, middle * 1e3, slow * 1e3, run.wrong, verdict);
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

Json crowds(const ServerProcess& served, const Request& request, Aims& aims) {
    Json rows = Json::array();
    for (Crowd what : {Crowd{.clients = 8, .objects = 1000, .jobs = 40'000},
                       Crowd{.clients = 100, .objects = 10'000, .jobs = 5000}}) {
        if (request.quick) what.jobs /= 5;
        rows.push_back(crowd(served, what, aims));
    }
    return rows;
}

Json scene(const ServerProcess& served, const Request& request, Aims& aims) {
    const SceneAgainstLocal run = measure_scene(served.address(), 100'000, 1000, 20 * request.rounds);
    const double local = median(run.local), remote = median(run.remote), above = median(run.above);
    const char* const verdict =
        aims.at_most("a scene of 100,000, 1,000 moved a frame: remote - local, ms", 3, above * 1e3);
    fmt::print(
        "scene of {}, {} moved per frame, {:.0f} changes  local {:.3f} ms, remote {:.3f} ms, difference {:.3f} ms; "
        "opening {:.1f} ms{}{}\n",
        run.objects, run.moved, run.changes, local * 1e3, remote * 1e3, above * 1e3, run.opening * 1e3,
        run.same ? "" : "  DIFFERS", verdict);
    return {{"objects", run.objects},         {"moved", run.moved},       {"changes", run.changes},
            {"local_seconds", local},         {"remote_seconds", remote}, {"above_seconds", above},
            {"opening_seconds", run.opening}, {"same", run.same}};
}

int run(const Request& request) {
    std::optional<io::AtomicFile> file;
    if (!request.json.empty()) file.emplace(request.json);
    const ServerProcess served(OCTOPAIR_PROGRAM, {"--threads", "2"});
    Json all = machine_json();
    all["rounds"] = request.rounds;
    Aims aims;
    all["against_local"] = against_local(served, request, aims);
    all["crowds"] = crowds(served, request, aims);
    all["scene"] = scene(served, request, aims);
    all["aims"] = aims.json();
    if (file) {
        file->write(all.dump(1) + '\n');
        file->commit();
    }
    return 0;
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
