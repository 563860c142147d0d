// octopair generate: writes random scenes to .npy files. Writes the boxes while it makes them, so a large scene needs little memory.
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "cli/command/interrupt.hpp"
#include "cli/command/option_values.hpp"
#include "cli/command/progress_line.hpp"
#include "cli/subcommands.hpp"
#include "io/boxes/npy_header.hpp"
#include "io/files/atomic_file.hpp"
#include "io/formats/format_choice.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"

namespace octopair::cli {

namespace {

struct GenerateRequest {
    samples::SceneSpec spec;
    bool moving = false;  // true if --frames is given
    std::string output;
    bool quiet = false;
};

int run_generate(const GenerateRequest& request) {
    const Interrupt interrupt;
    const samples::SceneSpec& spec = request.spec;
    ProgressLine progress(!request.quiet);
    io::AtomicFile file(request.output);
    using Shape = std::array<std::uint64_t, 3>;
    const Shape shape = {spec.frames, spec.objects, 6};
    file.write(io::make_npy_header(io::NpyType::float32, request.moving ? std::span(shape) : std::span(shape).last(2)));
    std::uint64_t written = 0;
    samples::generate_scene(spec, [&](std::span<const Box3f> boxes) {
        if (interrupt.token().stop_requested()) throw Error(ErrorCode::cancelled, "interrupted");
        file.write(std::as_bytes(boxes));
        written += boxes.size();
        progress.show("generating", double(written) / (double(spec.objects) * double(spec.frames)));
    });
    file.commit();
    progress.clear();
    if (!request.quiet) {
        fmt::print(stderr, "{}: {} objects{}, {}, seed {}\n", request.output, grouped(spec.objects),
                   request.moving ? fmt::format(" in each of {} frames", grouped(spec.frames)) : "", spec.kind,
                   spec.seed);
    }
    return 0;
}

HelpSection kinds() {
    HelpSection section{"Kinds", {}};
    for (const std::string_view kind : samples::scene_kinds()) {
        section.entries.push_back({std::string(kind), std::string(samples::scene_description(kind))});
    }
    return section;
}

void add_numbers(Command& command, GenerateRequest& request) {
    constexpr std::uint64_t max_objects = std::numeric_limits<std::uint32_t>::max();
    command
        .add_option(
            "--objects",
            [&request](const std::string& text) { request.spec.objects = parse_count("--objects", text, max_objects); },
            "number of objects")
        .type_name("N")
        .required();
    command
        .add_option(
            "--seed", [&request](const std::string& text) { request.spec.seed = parse_count("--seed", text); },
            "another seed gives another scene (default 0)")
        .type_name("S");
    command
        .add_option(
            "--frames",
            [&request](const std::string& text) {
                request.spec.frames = parse_count("--frames", text, 1'000'000);
                request.moving = true;
            },
            "make a moving scene with F frames")
        .type_name("F");
}

}  // namespace

void add_generate(Command& program, Action& action) {
    Command command = program.add_subcommand("generate", "make a random scene; the same seed gives the same bytes");
    const auto request = std::make_shared<GenerateRequest>();
    command.begin_section("Scene");
    command
        .add_option(
            "KIND",
            [request](const std::string& kind) {
                check_value("KIND", samples::scene_kinds(), kind);
                request->spec.kind = kind;
            },
            "kind of scene, see below")
        .required();
    add_numbers(command, *request);
    command.begin_section("Output");
    command.add_option("-o,--output", request->output, "the file to write").type_name("FILE.npy").required();
    command.add_flag("--quiet", request->quiet, "no progress and no summary on standard error");
    command.add_help_section(kinds());
    command.set_examples({"octopair generate uniform --objects 1000000 -o boxes.npy"});
    command.callback([request, &action] {
        if (request->output != "-" && io::ending_of(request->output) != ".npy") {
            throw Error(ErrorCode::usage,
                        fmt::format("--output: the name of '{}' does not end in .npy", request->output));
        }
        action = [request] { return run_generate(*request); };
    });
}

}  // namespace octopair::cli
