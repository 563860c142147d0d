// octopair detect: parses and checks the options, runs the search, and reports the outcome.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "cli/command/failure.hpp"
#include "cli/command/interrupt.hpp"
#include "cli/command/words.hpp"
#include "cli/detect/detect_options.hpp"
#include "cli/detect/detection.hpp"
#include "cli/detect/event_detection.hpp"
#include "cli/engine_choice.hpp"
#include "cli/output/report.hpp"
#include "cli/subcommands.hpp"
#include "io/files/atomic_file.hpp"
#include "io/formats.hpp"
#include "io/results/pair_writer.hpp"
#ifdef OCTOPAIR_WITH_MPI
#include "cli/ranks/cluster.hpp"
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
    return request.fail_on_collision && (report.pairs > 0 || report.truncated) ? 1 : 0;
}

/// Detects on the processes of a group; its first rank says what came of it.
DetectReport detect_and_report(const DetectRequest& request, Group& group, const std::stop_token& stop) {
    std::optional<Outcome> outcome;
    group.together([&] {
        if (group.first()) outcome.emplace(request, stop);
    });
    const DetectReport report = request.events ? detect_events(request, stop) : detect(request, group, stop);
    group.together([&] {
        if (outcome) outcome->write(report);
    });
    return report;
}

#ifdef OCTOPAIR_WITH_MPI
/// Runs the search on all ranks. Only rank 0 writes the outcome and the error message.
int run_on_ranks(const DetectRequest& request) {
    const Interrupt interrupt;
    Cluster cluster;
    try {
        return exit_status_of(request, detect_and_report(request, cluster, interrupt.token()));
    } catch (const Error& error) {
        if (!cluster.ends_alike()) throw;
        if (cluster.first()) (void)fail(error);
        // Without this barrier, mpirun may kill the first rank in the middle of its message when another rank exits.
        cluster.together([] {});
        return exit_status(error.code());
    }
}
#endif

int run_detect(const DetectRequest& request) {
#ifdef OCTOPAIR_WITH_MPI
    if (request.engine.has_ranks()) return run_on_ranks(request);
#endif
    const Interrupt interrupt;
    Group alone;
    return exit_status_of(request, detect_and_report(request, alone, interrupt.token()));
}

void add_what(Command& command, DetectRequest& request) {
    add_scene_options(command, request);
    add_pipeline_options(command, request.pipeline);
    command.add_flag("--events", request.events,
                     "for a moving scene: write only the pairs that begin or end, as rows frame,event,a,b");
}

void add_outcome(Command& command, DetectRequest& request) {
    const Option output = command
                              .add_option("--output", request.output,
                                          "file for the pairs; its ending .npy, .csv or .jsonl gives the format "
                                          "(default: CSV on standard output)")
                              .type_name("FILE");
    command
        .add_option(
            "--index-type",
            [&request](const std::string& word) {
                check_word({"--index-type", {"uint32", "uint64"}, {}}, word);
                request.wide_indices = word == "uint64";
            },
            "type of indices in .npy: uint32 (default), or uint64 with --engine mpi (default for more than 2^32 - 1 "
            "objects)")
        .type_name("TYPE");
    add_order_options(command, request, "write only the first N pairs (with --events: rows)");
    command.add_flag("--count-only", request.count_only, "print only the number of pairs").excludes(output);
    command.add_flag("--verify", request.verify,
                     "check the pairs of boxes with a second algorithm; exit status 6 if they differ");
    command.add_flag("--fail-on-collision", request.fail_on_collision, "exit with status 1 if any pair is found");
    command.add_option("--stats", request.stats, "write statistics of the run as JSON").type_name("FILE");
    command.add_flag("--quiet", request.quiet, "no progress and no summary on standard error");
}

void check_index_type(const DetectRequest& request) {
    if (!request.wide_indices) return;
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::usage, "--index-type uint64: " + why); };
    if (!request.engine.has_ranks()) refuse("only with --engine mpi");
    if (!io::is_array_file(request.output) && !request.count_only) refuse("only in an .npy file");
}

/// Throws: Error{usage} for options whose results the second algorithm cannot check.
void check_verify_options(const DetectRequest& request) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::usage, "--verify: " + why); };
    if (request.events) refuse("not with --events; without it, the pairs of each frame are verified");
    if (request.limit && has_filters(request)) refuse("not with --limit and filters, which end the search early");
    if (request.wide_indices) refuse("not with --index-type uint64");
}

/// Throws: Error{usage} if two outputs go to the same regular file, because one would overwrite the other.
void check_outputs(const DetectRequest& request) {
    namespace fs = std::filesystem;
    const std::pair<std::string_view, fs::path> outputs[] = {
        {"--output", request.output}, {"--report", request.pipeline.report}, {"--stats", request.stats}};
    std::error_code no_path;  // ignored: the writer reports an invalid path
    const auto place = [&](const fs::path& path) { return fs::weakly_canonical(fs::absolute(path, no_path), no_path); };
    for (const auto& [option, path] : outputs) {
        for (const auto& [earlier_option, earlier] : outputs) {
            if (option == earlier_option) break;
            if (path.empty() || earlier.empty() || place(path) != place(earlier)) continue;
            if (fs::exists(path, no_path) && !fs::is_regular_file(path, no_path)) continue;
            throw Error(ErrorCode::usage,
                        fmt::format("{}: {} is also the file of {}", option, path.native(), earlier_option));
        }
    }
}

}  // namespace

void add_detect(Command& program, Action& action) {
    Command command = program.add_subcommand("detect", "find the colliding pairs of a scene");
    const auto request = std::make_shared<DetectRequest>();
    add_what(command, *request);
    add_outcome(command, *request);
    add_engine_options(command, request->engine);
#ifdef OCTOPAIR_WITH_SERVICE
    add_server_options(command, request->engine.server);
#endif
    command.callback([request, &action] {
        check_engine_choice(request->engine);
        if (!request->output.empty()) (void)io::result_format(request->output);
        if (request->events) check_event_options(*request);
        check_index_type(*request);
        if (request->verify) check_verify_options(*request);
        check_pipeline_options(*request);
        check_outputs(*request);
        action = [request] { return run_detect(*request); };
    });
}

}  // namespace octopair::cli
