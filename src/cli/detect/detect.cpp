// octopair detect: runs the search, and reports the outcome.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "cli/command/interrupt.hpp"
#include "cli/command/program_main.hpp"
#include "cli/detect/detect_options.hpp"
#include "cli/detect/detect_report.hpp"
#include "cli/detect/detection.hpp"
#include "cli/detect/event_detection.hpp"
#include "cli/detect/frame_search.hpp"
#include "cli/subcommands.hpp"
#include "io/files/atomic_file.hpp"
#ifdef OCTOPAIR_WITH_MPI
#include "cli/detect/rank_group.hpp"
#include "cli/ranks/cluster.hpp"
#include "engine/mpi/leading/leading.hpp"
#endif

namespace octopair::cli {

namespace {

/// Writes the outcome of a run besides its pairs: the count, the statistics, and the summary.
class Outcome {
public:
    /// Opens the file of --stats now, so that an unwritable path fails before the search.
    Outcome(const DetectRequest& request, std::stop_token stop) : request_(request), stop_(std::move(stop)) {
        if (!request.stats.empty()) stats_.emplace(request.stats);
    }

    void write(const DetectReport& report) {
        if (request_.count_only) {
            io::StandardOutput out(stop_);
            out.write(std::to_string(report.pairs) + '\n');
            out.commit();
        }
        if (stats_) {
            stats_->write(stats_json(report));
            stats_->commit();
        }
        if (!request_.quiet) fmt::print(stderr, "{}", summary_text(report));
    }

private:
    const DetectRequest& request_;
    std::stop_token stop_;
    std::optional<io::AtomicFile> stats_;
};

int exit_status_of(const DetectRequest& request, const DetectReport& report) {
    const std::uint64_t approved =
        report.statuses ? report.statuses->found[std::size_t(io::Status::approved)] : std::uint64_t(0);
    return request.fail_on_collision && (report.pairs > approved || report.truncated) ? 1 : 0;
}

/// Runs the search on the processes of a group. Its first rank writes the outcome.
DetectReport detect_and_report(const DetectRequest& request, SearchGroup& searchers, const std::stop_token& stop) {
    Group& group = searchers.processes();
    std::optional<Outcome> outcome;
    group.together([&] {
        if (group.first()) outcome.emplace(request, stop);
    });
    DetectReport report = request.events ? detect_events(request, {}, stop) : detect(request, searchers, stop);
    group.together([&] {
        if (outcome) outcome->write(report);
    });
    return report;
}

#ifdef OCTOPAIR_WITH_MPI
/// Finds events with the MPI engine. Only rank 0 calls the engine; the other ranks execute its calls. Returns the exit status.
int find_events_on_ranks(const DetectRequest& request, Cluster& cluster, const std::stop_token& stop) {
    LeadingOptions options;
    options.threads = describe_engine(request.engine).threads;
    if (!cluster.first()) {
        follow(MPI_COMM_WORLD, options);
        return 0;
    }
    options.on_silent_rank = [](const std::string& what) {
        Cluster::abort(fail(Error(ErrorCode::engine_failed, what)));
    };
    RankedEngine ranked{make_leading_engine(MPI_COMM_WORLD, options), cluster.ranks()};
    try {
        Outcome outcome(request, stop);
        const DetectReport report = detect_events(request, std::move(ranked), stop);
        outcome.write(report);
        return exit_status_of(request, report);
    } catch (const Error& error) {
        return fail(error);
    }
}

/// Runs the search on all ranks. Only rank 0 writes the outcome and the error message.
int run_on_ranks(const DetectRequest& request) {
    const Interrupt interrupt;
    Cluster cluster;
    try {
        cluster.require_same(option_facts(request));
        if (request.events) {
            cluster.joint(check_leading_threads);
            // All ranks end with the status of rank 0.
            return cluster.all_gather(find_events_on_ranks(request, cluster, interrupt.token())).front();
        }
        const DetectReport report = detect_and_report(request, *ranks_of(cluster), interrupt.token());
        // Only rank 0 knows the statuses.
        return cluster.all_gather(exit_status_of(request, report)).front();
    } catch (const Error& error) {
        if (!cluster.ends_alike()) throw;
        return cluster.fail_together(error);
    }
}
#endif

int run_detect(const DetectRequest& request) {
#ifdef OCTOPAIR_WITH_MPI
    if (request.engine.has_ranks()) return run_on_ranks(request);
#endif
    const Interrupt interrupt;
    return exit_status_of(request, detect_and_report(request, *one_process(), interrupt.token()));
}

}  // namespace

void add_detect(Command& program, Action& action) {
    Command command = program.add_subcommand("detect", "find the colliding pairs of a scene");
    const auto request = std::make_shared<DetectRequest>();
    add_detect_options(command, *request);
    command.set_examples({"octopair detect boxes.npy -o pairs.npy",
                          "octopair detect parts.glb --margin 0.01 -o near.jsonl",
                          "octopair detect moving.npy --events -o events.csv"});
    command.callback([command, request, &action] {
        check_detect_options(*request);
        request->given = command.given_options();
        action = [request] { return run_detect(*request); };
    });
}

}  // namespace octopair::cli
