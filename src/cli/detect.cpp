// octopair detect: the options, and what is made of the result.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "cli/detection.hpp"
#include "cli/engine_choice.hpp"
#include "cli/event_detection.hpp"
#include "cli/interrupt.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/subcommands.hpp"
#include "cli/words.hpp"
#include "io/atomic_file.hpp"
#include "io/pair_writer.hpp"

namespace octopair::cli {

namespace {

int run_detect(const DetectRequest& request) {
    const Interrupt interrupt;
    // Opened at once, so that a place that cannot be written is known before the work.
    std::optional<io::AtomicFile> stats;
    if (!request.stats.empty()) stats.emplace(request.stats);
    const DetectReport report =
        request.events ? detect_events(request, interrupt.token()) : detect(request, interrupt.token());
    if (request.count_only) {
        io::StandardOutput out(interrupt.token());
        out.write(std::to_string(report.pairs) + '\n');
        out.commit();
    }
    if (stats) {
        stats->write(stats_json(report));
        stats->commit();
    }
    if (!request.quiet) fmt::print(stderr, "{}", summary_text(report));
    return request.fail_on_collision && (report.pairs > 0 || report.truncated) ? 1 : 0;
}

void add_what(CLI::App& command, DetectRequest& request) {
    command.add_option("INPUT", request.inputs, "scene files: .npy, .csv or a mesh scene; several are one set")
        ->required();
    command.add_option("--against", request.against, "only pairs (a in INPUT, b in FILE)")->type_name("FILE");
    command
        .add_option_function<std::string>(
            "--stage",
            [](const std::string& word) {
                check_word({"--stage", {"pairs"}, {"objects", "features"}}, word);
            },
            "how far down the pipeline: pairs (the only one yet)")
        ->type_name("STAGE");
    command
        .add_option_function<std::string>(
            "--objects",
            [&request](const std::string& word) {
                check_word({"--objects", {"node", "triangle"}, {}}, word);
                request.mesh_objects = word == "node" ? io::MeshObjects::node : io::MeshObjects::triangle;
            },
            "what counts as one object of a mesh file: node (default) or triangle")
        ->type_name("WHAT");
    command
        .add_option_function<std::string>(
            "--margin", [&request](const std::string& text) { request.margin = parse_length("--margin", text); },
            "pairs count up to a gap of M on every axis (default 0)")
        ->type_name("M");
    command.add_option("--padding", request.padding, "shape (n,): each object's own clearance")->type_name("FILE.npy");
    command.add_flag("--events", request.events,
                     "of a moving scene: only what began and ended, as rows frame,event,a,b (begin, end)");
}

void add_result(CLI::App& command, DetectRequest& request) {
    auto* output =
        command.add_option("--output", request.output,
                           "where the pairs go, by its ending .npy .csv .jsonl (default: CSV on standard output)");
    output->type_name("FILE");
    command
        .add_option_function<std::string>(
            "--order",
            [&request](const std::string& word) {
                check_word({"--order", {"ascending", "octal"}, {}}, word);
                request.order = word == "octal" ? Order::octal : Order::ascending;
            },
            "order of the pairs: ascending (default) or octal")
        ->type_name("ORDER");
    command.add_flag("--count-only", request.count_only, "print the number of pairs alone")->excludes(output);
    command
        .add_option_function<std::string>(
            "--limit", [&request](const std::string& text) { request.limit = parse_count("--limit", text); },
            "the first N pairs (with --events: rows)")
        ->type_name("N");
    command.add_flag("--fail-on-collision", request.fail_on_collision, "exit status 1 if any pair was found");
    command.add_option("--stats", request.stats, "write numbers about the run as JSON")->type_name("FILE");
    command.add_flag("--quiet", request.quiet, "no progress and no summary on standard error");
}

}  // namespace

void add_detect(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("detect", "find the colliding pairs of a scene");
    const auto request = std::make_shared<DetectRequest>();
    add_what(*command, *request);
    add_result(*command, *request);
    add_engine_options(*command, request->engine);
    command->callback([request, &action] {
        check_engine_choice(request->engine);
        if (!request->output.empty()) (void)io::pair_format(request->output);
        if (request->events) check_event_options(*request);
        action = [request] { return run_detect(*request); };
    });
}

}  // namespace octopair::cli
