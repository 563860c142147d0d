#include "cli/stage.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/detection.hpp"
#include "cli/words.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

#ifdef OCTOPAIR_WITH_PIPELINE
constexpr bool with_pipeline = true;
#else
constexpr bool with_pipeline = false;
#endif

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::usage, what); }

Stage parse_stage(const std::string& word) {
    check_word({"--stage", stage_names(), {"objects", "features"}}, word);
    return word == "pairs" ? Stage::pairs : Stage::objects;
}

std::vector<std::string> all_inputs(const DetectRequest& request) {
    std::vector<std::string> inputs = request.inputs;
    if (!request.against.empty()) inputs.push_back(request.against);
    return inputs;
}

/// An input without shapes, or none.
std::optional<std::string> input_of_boxes(const DetectRequest& request) {
    for (const std::string& input : all_inputs(request)) {
        if (!io::is_mesh_file(input) && !io::is_json_file(input)) return input;
    }
    return std::nullopt;
}

}  // namespace

std::vector<std::string_view> stage_names() {
    return with_pipeline ? std::vector<std::string_view>{"pairs", "objects"} : std::vector<std::string_view>{"pairs"};
}

void add_pipeline_options(CLI::App& command, PipelineRequest& request) {
    command
        .add_option_function<std::string>(
            "--stage", [&request](const std::string& word) { request.stage = parse_stage(word); },
            "how far down the pipeline: pairs of boxes, or objects that meet (default: objects for meshes)")
        ->type_name("STAGE");
    command.add_option("--exclude", request.exclude, "leave out pairs by rules of names, see docs/formats.md")
        ->type_name("RULES.json");
    command
        .add_option_function<std::string>(
            "--same-parent",
            [&request](const std::string& word) {
                check_word({"--same-parent", {"include", "exclude"}, {}}, word);
                request.same_parent = word == "exclude";
            },
            "pairs of objects of one parent: include (default) or exclude")
        ->type_name("WHAT");
}

Stage stage_of(const DetectRequest& request) {
    if (request.pipeline.stage) return *request.pipeline.stage;
    const bool may_be_exact = with_pipeline && !request.events && request.mesh_objects == io::MeshObjects::node;
    return may_be_exact && !input_of_boxes(request) ? Stage::objects : Stage::pairs;
}

bool has_filters(const DetectRequest& request) {
    return stage_of(request) != Stage::pairs || !request.pipeline.exclude.empty() ||
           request.pipeline.same_parent.value_or(false);
}

void check_pipeline_options(const DetectRequest& request) {
    if (!has_filters(request)) return;
    const Stage stage = stage_of(request);
    const std::string asked = stage != Stage::pairs               ? "--stage objects"
                              : !request.pipeline.exclude.empty() ? "--exclude"
                                                                  : "--same-parent exclude";
    if (!with_pipeline) refuse(asked + ": this octopair was built without the pipeline");
    if (request.engine.kind == EngineKind::mpi)
        refuse(asked + ": not with --engine mpi, which has --stage pairs alone");
    if (request.events) refuse(asked + ": not with --events");
    if (request.mesh_objects == io::MeshObjects::triangle) refuse(asked + ": not with --objects triangle yet");
    if (stage == Stage::pairs) return;
    if (const auto input = input_of_boxes(request)) {
        refuse(fmt::format("{}: {} has boxes, not shapes; --stage pairs is for these", asked, *input));
    }
}

}  // namespace octopair::cli
