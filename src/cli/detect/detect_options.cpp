#include "cli/detect/detect_options.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command/command.hpp"
#include "cli/command/option_values.hpp"
#include "cli/detect/event_detection.hpp"
#include "cli/engine_choice.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

void add_objects_option(Command& command, DetectRequest& request) {
    command
        .add_option(
            "--objects",
            [&request](const std::string& word) {
                check_value("--objects", {"node", "triangle"}, word);
                request.mesh_objects = word == "node" ? io::MeshObjects::node : io::MeshObjects::triangle;
            },
            "objects of a mesh file: node (default) or triangle")
        .type_name("WHAT");
}

#ifdef OCTOPAIR_WITH_MESHES
void add_reader_options(Command& command, DetectRequest& request) {
    command
        .add_option("--reader", request.reader.command,
                    "program that reads the inputs and writes a model stream; it gets the name of a file")
        .type_name("COMMAND");
    command
        .add_option("--include-type", request.reader.include_types,
                    "IFC: also read elements of this type, for example IfcSpace; may be repeated")
        .type_name("TYPE");
}
#endif

void add_margin_option(Command& command, DetectRequest& request) {
    command
        .add_option(
            "--margin", [&request](const std::string& text) { request.margin = parse_length("--margin", text); },
            "largest gap of a pair, for boxes on every axis (default 0)")
        .type_name("M");
}

}  // namespace

void add_scene_options(Command& command, DetectRequest& request, const std::string& inputs) {
    command.begin_section("Input");
    command.add_option("INPUT", request.inputs, inputs).required();
    command.add_option("--against", request.against, "only pairs of an object of INPUT and an object of FILE")
        .type_name("FILE");
    add_objects_option(command, request);
#ifdef OCTOPAIR_WITH_MESHES
    add_reader_options(command, request);
#endif
    command.begin_section("What counts");
    add_margin_option(command, request);
    command.add_option("--padding", request.padding, "clearance of each object: an array of shape (n,)")
        .type_name("FILE.npy");
}

void add_order_options(Command& command, DetectRequest& request, const std::string& limited) {
    command
        .add_option(
            "--order",
            [&request](const std::string& word) {
                check_value("--order", {"ascending", "octal"}, word);
                request.order = word == "octal" ? Order::octal : Order::ascending;
            },
            "order of the pairs: ascending (default) or octal")
        .type_name("ORDER");
    command
        .add_option(
            "--limit", [&request](const std::string& text) { request.limit = parse_count("--limit", text); }, limited)
        .type_name("N");
}

io::ReaderChoice reader_of(const DetectRequest& request) {
    io::ReaderChoice reader = request.reader;
#ifdef OCTOPAIR_WITH_PIPELINE
    reader.chord = request.pipeline.chord.value_or(0);
#endif
    return reader;
}

Option add_output_option(Command& command, std::string& output, const char* formats) {
    return command
        .add_option("-o,--output", output,
                    fmt::format("file for the pairs: {} (default: CSV on standard output)", formats))
        .type_name("FILE");
}

namespace {

void add_what(Command& command, DetectRequest& request) {
    add_scene_options(command, request, ".npy, .csv, .json or mesh files; several files form one set");
    add_stage_options(
        command, request.pipeline,
        "last stage: pairs of boxes, objects that meet (default for meshes and .json), features (contacts)");
    command.add_flag("--events", request.events,
                     "of a moving scene: only pairs that begin or end, as rows frame,event,a,b");
    command.begin_section("Exact stages");
    add_exact_options(command, request.pipeline);
}

void add_output_options(Command& command, DetectRequest& request) {
    command.begin_section("Output");
    const Option output = add_output_option(command, request.output, ".npy, .csv, .jsonl or .bcf");
    command
        .add_option(
            "--index-type",
            [&request](const std::string& word) {
                check_value("--index-type", {"uint32", "uint64"}, word);
                request.wide_indices = word == "uint64";
            },
            "type of indices in .npy: uint32 (default), or uint64 with --engine mpi")
        .type_name("TYPE");
    add_order_options(command, request, "write only the first N pairs (with --events: rows)");
    command.add_flag("--count-only", request.count_only, "print only the number of pairs").excludes(output);
    add_report_options(command, request.pipeline);
    command.add_option("--stats", request.stats, "write statistics of the run as JSON").type_name("FILE");
    command.add_flag("--verify", request.verify,
                     "check the result by a second algorithm; exit status 6 if it is wrong");
    command.add_flag("--fail-on-collision", request.fail_on_collision,
                     "exit status 1 if a pair is found that is not approved (--statuses), 3 if an input has no object");
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

std::vector<FileOption> input_files(const DetectRequest& request) {
    std::vector<FileOption> files;
    files.reserve(request.inputs.size() + 4);
    for (const std::string& input : request.inputs) files.push_back({"", input});
    for (const auto& [option, path] :
         {std::pair("--against", request.against), std::pair("--padding", request.padding),
          std::pair("--exclude", request.pipeline.exclude), std::pair("--baseline", request.pipeline.baseline)}) {
        files.push_back({option, path});
    }
    return files;
}

/// Returns all files that the request reads.
std::vector<FileOption> all_input_files(const DetectRequest& request) {
    std::vector<FileOption> files = input_files(request);
    const ServerChoice& server = request.engine.server;
    for (const auto& [option, path] :
         {std::pair("--token-file", server.token_file), std::pair("--tls-authority", server.options.authority),
          std::pair("--tls-certificate", server.options.certificate), std::pair("--tls-key", server.options.key)}) {
        files.push_back({option, path});
    }
    return files;
}

/// Refuses streams (such as pipes) as inputs of ranks, which cannot share a stream. Otherwise opens the streams now, before signals
/// are blocked.
void check_streams(const DetectRequest& request) {
    for (const auto& [option, path] : input_files(request)) {
        if (path.empty() || !io::is_stream(path)) continue;
        if (request.engine.has_ranks())
            throw Error(ErrorCode::usage, fmt::format("{}: --engine mpi cannot read from a stream", path));
        (void)io::InputFile(path);
    }
}

}  // namespace

void add_detect_options(Command& command, DetectRequest& request) {
    add_what(command, request);
    add_output_options(command, request);
    add_engine_options(command, request.engine);
#ifdef OCTOPAIR_WITH_SERVICE
    add_server_options(command, request.engine.server);
#endif
}

void check_detect_options(DetectRequest& request) {
    check_engine_choice(request.engine);
    check_streams(request);
    if (request.output == "-") request.output.clear();  // empty: CSV on standard output
    if (!request.output.empty()) (void)io::result_format(request.output);
    if (request.events) check_event_options(request);
    check_index_type(request);
    if (request.verify) check_verify_options(request);
    check_outputs(all_input_files(request), {{"--output", request.output},
                                             {"--statuses", request.pipeline.statuses},
                                             {"--report", request.pipeline.report},
                                             {"--stats", request.stats}});
    check_pipeline_options(request);
}

}  // namespace octopair::cli
