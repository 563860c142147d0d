#include "cli/detect/pipeline_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/command/command.hpp"
#include "cli/command/option_values.hpp"
#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"
#include "io/formats/format_choice.hpp"
#include "io/json/exclusion_rules.hpp"
#include "io/results/collision_row.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

#ifdef OCTOPAIR_WITH_PIPELINE
constexpr bool with_pipeline = true;
#else
constexpr bool with_pipeline = false;
#endif

#ifdef OCTOPAIR_WITH_MESHES
constexpr bool with_bcf = true;
#else
constexpr bool with_bcf = false;
#endif

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::usage, what); }

Stage parse_stage(const std::string& word) {
    if (!with_pipeline && (word == "objects" || word == "features")) {
        refuse("--stage: this octopair was built without '" + word + "'; it has: pairs");
    }
    check_value("--stage", stage_names(), word);
    return word == "pairs" ? Stage::pairs : word == "objects" ? Stage::objects : Stage::features;
}

AdjacentTriangles parse_adjacent(const std::string& word) {
    check_value("--adjacent", {"beyond-shared", "exclude", "include"}, word);
    return word == "exclude"   ? AdjacentTriangles::exclude
           : word == "include" ? AdjacentTriangles::include
                               : AdjacentTriangles::beyond_shared;
}

std::uint32_t parse_max_contacts(const std::string& text) {
    const std::uint64_t number = parse_count("--max-contacts", text);
    if (number > 0xFFFFFFFF) refuse("--max-contacts: " + text + " is more than 4294967295");
    return std::uint32_t(number);
}

/// Returns the classes of --classes, a list with commas.
ClassSet parse_classes(const std::string& list) {
    std::vector<std::string_view> words;
    for (std::size_t i = 1; i < collision_classes; ++i) words.push_back(io::word_of(CollisionClass(i)));
    ClassSet classes;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string word = list.substr(begin, end - begin);
        check_value("--classes", words, word);
        classes.set(1 + std::size_t(std::find(words.begin(), words.end(), word) - words.begin()));
        begin = end + 1;
    }
    return classes;
}

std::vector<std::string> all_inputs(const DetectRequest& request) {
    std::vector<std::string> inputs = request.inputs;
    if (!request.against.empty()) inputs.push_back(request.against);
    return inputs;
}

}  // namespace

std::vector<std::string_view> stage_names() {
    return with_pipeline ? std::vector<std::string_view>{"pairs", "objects", "features"}
                         : std::vector<std::string_view>{"pairs"};
}

std::string class_list(const ClassSet& classes) {
    std::string list;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        if (classes[i]) list += fmt::format("{}{}", list.empty() ? "" : ",", io::word_of(CollisionClass(i)));
    }
    return list;
}

void add_stage_option(Command& command, PipelineRequest& request, const std::string& description) {
    command
        .add_option(
            "--stage", [&request](const std::string& word) { request.stage = parse_stage(word); }, description)
        .type_name("STAGE");
}

void add_up_option(Command& command, PipelineRequest& request, const std::string& description) {
    command
        .add_option(
            "--up",
            [&request](const std::string& word) {
                check_value("--up", {"y", "z"}, word);
                request.space.up = word == "y" ? io::UpAxis::y : io::UpAxis::z;
            },
            description)
        .type_name("AXIS");
}

void add_unit_option(Command& command, PipelineRequest& request, const std::string& description) {
    command
        .add_option(
            "--unit",
            [&request](const std::string& word) {
                check_value("--unit", {"um", "mm", "cm", "dm", "m", "km", "in", "ft"}, word == "µm" ? "um" : word);
                request.space.unit = word == "um" ? "µm" : word;
            },
            description)
        .type_name("UNIT");
}

void add_stage_options(Command& command, PipelineRequest& request, const std::string& description) {
    add_stage_option(command, request, description);
    command
        .add_option("--exclude", request.exclude,
                    "leave out pairs by rules on names or relations, see docs/formats.md; or fills,assembly,system")
        .type_name("RULES.json");
    command
        .add_option(
            "--same-parent",
            [&request](const std::string& word) {
                check_value("--same-parent", {"include", "exclude"}, word);
                request.same_parent = word == "exclude";
            },
            "pairs of objects with the same parent: include (default) or exclude")
        .type_name("WHAT");
}

void add_exact_options(Command& command, PipelineRequest& request) {
    command
        .add_option(
            "--adjacent", [&request](const std::string& word) { request.adjacent = parse_adjacent(word); },
            "beyond-shared (default), exclude or include: pairs of triangles that share corners")
        .type_name("WHICH");
    command
        .add_option(
            "--max-contacts", [&request](const std::string& text) { request.max_contacts = parse_max_contacts(text); },
            "with --stage features: most contacts of a pair, the deepest first (default 16)")
        .type_name("N");
    const auto add_length = [&](const char* name, std::optional<double>& value, const char* what) {
        const auto parse = [name, &value](const std::string& text) { value = parse_length(name, text); };
        command.add_option(name, parse, what).type_name("LENGTH");
    };
    add_length("--tolerance", request.tolerance,
               "with --stage features: overlaps that are at most this thick are touching; leaves out nothing");
    add_length("--chord", request.chord,
               "error of tessellated curves in the input; the default tolerance becomes twice this");
    add_length("--duplicate-tolerance", request.duplicate_tolerance,
               "with --stage features: farthest corners of duplicates (default: the tolerance)");
    add_length("--min-depth", request.min_depth,
               "with --stage features: leave out collisions that are certainly less deep, of any class");
    command
        .add_option(
            "--classes", [&request](const std::string& list) { request.classes = parse_classes(list); },
            "only clearance, collision, touching, penetrating, contained, duplicate, undecided (with commas)")
        .type_name("LIST");
    add_length("--weld", request.weld, "close gaps in meshes: join vertices that are at most this far apart");
}

void add_report_options(Command& command, PipelineRequest& request) {
    command
        .add_option("--baseline", request.baseline,
                    "compare with an older result: mark collisions as new, same or gone")
        .type_name("OLD.jsonl");
    command
        .add_option("--statuses", request.statuses,
                    "what people decided about collisions: read, and written with what is found")
        .type_name("FILE.json");
    command.add_option("--report", request.report, "write an HTML page about the collisions").type_name("FILE.html");
    add_up_option(command, request,
                  "axis that points up in the report and in BCF: y or z (default: that of the file, or z)");
    add_unit_option(
        command, request,
        "unit of lengths in the report and in BCF: um, mm, cm, dm, m, km, in or ft (default: that of the file)");
}

std::optional<std::string> input_of_boxes(const DetectRequest& request) {
    if (!request.reader.command.empty()) return std::nullopt;
    for (const std::string& input : all_inputs(request)) {
        const io::SceneFormat format = io::scene_format(input);
        if (format == io::SceneFormat::npy || format == io::SceneFormat::csv) return input;
    }
    return std::nullopt;
}

Stage stage_of(const DetectRequest& request) {
    if (request.pipeline.stage) return *request.pipeline.stage;
    return with_pipeline && !request.events && !input_of_boxes(request) ? Stage::objects : Stage::pairs;
}

double chord_of(const DetectRequest& request, const SetPair& sets) {
    double chord = request.pipeline.chord.value_or(0);
    for (const InputSet* set : {&sets.first, sets.second}) {
        if (set != nullptr) chord = std::max(chord, set->scene.chord);
    }
    return chord;
}

double default_tolerance_of(const DetectRequest& request, const SetPair& sets) {
    double largest = 0;
    for (const InputSet* set : {&sets.first, sets.second}) {
        if (set != nullptr) largest = std::max(largest, set->scene.largest_rounded);
    }
    constexpr double relative_step = 0x1p-23;
    return 2 * chord_of(request, sets) + 2 * largest * relative_step;
}

double tolerance_of(const DetectRequest& request, const SetPair& sets) {
    return request.pipeline.tolerance ? *request.pipeline.tolerance : default_tolerance_of(request, sets);
}

bool has_filters(const DetectRequest& request) {
    return stage_of(request) != Stage::pairs || !request.pipeline.exclude.empty() ||
           request.pipeline.same_parent.value_or(false);
}

namespace {

/// Returns the option that makes filters necessary, for messages.
std::string filter_option(const DetectRequest& request) {
    switch (stage_of(request)) {
        case Stage::objects:
            return "--stage objects";
        case Stage::features:
            return "--stage features";
        case Stage::pairs:
            break;
    }
    return request.pipeline.exclude.empty() ? "--same-parent exclude" : "--exclude";
}

/// Returns the classes that the stage of a request gives. Requires: the stage is not Stage::pairs.
std::vector<CollisionClass> classes_of_stage(const DetectRequest& request) {
    const bool triangles = request.mesh_objects == io::MeshObjects::triangle;
    std::vector<CollisionClass> classes = {CollisionClass::clearance};
    if (stage_of(request) == Stage::objects) {
        classes.push_back(CollisionClass::collision);
    } else {
        classes.insert(classes.end(), {CollisionClass::touching, CollisionClass::penetrating});
    }
    if (!triangles) classes.insert(classes.end(), {CollisionClass::contained, CollisionClass::undecided});
    if (!triangles && stage_of(request) == Stage::features) classes.push_back(CollisionClass::duplicate);
    return classes;
}

/// Throws: Error{usage} for a class of --classes that the stage never gives.
void check_classes(const DetectRequest& request) {
    if (!request.pipeline.classes) return;
    if (stage_of(request) == Stage::pairs) refuse("--classes: only with --stage objects or features");
    std::vector<std::string_view> words;
    ClassSet given;
    for (const CollisionClass one : classes_of_stage(request)) {
        words.push_back(io::word_of(one));
        given.set(std::size_t(one));
    }
    const ClassSet never = *request.pipeline.classes & ~given;
    for (std::size_t i = 0; i < collision_classes; ++i) {
        if (!never[i]) continue;
        const bool objects = stage_of(request) == Stage::objects;
        const bool triangles = request.mesh_objects == io::MeshObjects::triangle;
        refuse(fmt::format("--classes: --stage {}{} never gives '{}'; it gives: {}", objects ? "objects" : "features",
                           triangles ? " of triangles" : "", io::word_of(CollisionClass(i)), fmt::join(words, ", ")));
    }
}

/// Checks the options that need a stage, or objects of a kind.
void check_exact_options(const DetectRequest& request) {
    const bool exact = stage_of(request) != Stage::pairs;
    const bool triangles = request.mesh_objects == io::MeshObjects::triangle;
    if (request.pipeline.adjacent && !(triangles && exact)) {
        refuse("--adjacent: only with --objects triangle and --stage objects or features");
    }
    if (request.pipeline.max_contacts && (triangles || stage_of(request) != Stage::features)) {
        refuse("--max-contacts: only with --stage features and --objects node");
    }
    for (const auto& [option, value] :
         {std::pair("--tolerance", request.pipeline.tolerance), std::pair("--chord", request.pipeline.chord),
          std::pair("--min-depth", request.pipeline.min_depth),
          std::pair("--duplicate-tolerance", request.pipeline.duplicate_tolerance)}) {
        if (value && stage_of(request) != Stage::features)
            refuse(fmt::format("{}: only with --stage features", option));
    }
    if (request.pipeline.duplicate_tolerance && triangles) {
        refuse("--duplicate-tolerance: only with --objects node");
    }
    if (request.pipeline.weld && (triangles || !exact)) {
        refuse("--weld: only with --stage objects or features and --objects node");
    }
    if (!triangles || !has_filters(request)) return;
    if (!request.pipeline.exclude.empty()) refuse("--exclude: not with --objects triangle");
    if (request.pipeline.same_parent) refuse("--same-parent: not with --objects triangle");
    if (!request.padding.empty()) refuse("--padding: with --objects triangle only at --stage pairs");
}

bool writes_bcf(const DetectRequest& request) {
    return !request.output.empty() && io::result_format(request.output) == io::ResultFormat::bcf;
}

/// Throws: Error{usage} if --output is a BCF file and the result cannot be topics.
void check_bcf_output(const DetectRequest& request) {
    if (!writes_bcf(request)) return;
    const auto refuse_output = [&](const char* why) { refuse(fmt::format("{}: {}", request.output, why)); };
    if (!with_bcf) refuse_output("this octopair was built without mesh files, and so without BCF");
    if (stage_of(request) == Stage::pairs) refuse_output("BCF holds collisions: only with --stage objects or features");
    if (request.mesh_objects == io::MeshObjects::triangle)
        refuse_output("BCF is about elements: not with --objects triangle");
}

/// Checks --baseline, --statuses, --report, --up and --unit.
void check_outcome_options(const DetectRequest& request) {
    const PipelineRequest& asked = request.pipeline;
    for (const auto& [option, value] :
         {std::pair("--baseline", &asked.baseline), std::pair("--statuses", &asked.statuses),
          std::pair("--report", &asked.report)}) {
        if (value->empty()) continue;
        if (stage_of(request) == Stage::pairs) refuse(fmt::format("{}: only with --stage objects or features", option));
        if (request.count_only) refuse(fmt::format("{}: not with --count-only", option));
    }
    const std::string page = io::ending_of(asked.report), older = io::ending_of(asked.baseline);
    if (!asked.report.empty() && page != ".html" && page != ".htm") {
        refuse(fmt::format("--report: {}: the name of a report must end in .html or .htm", asked.report));
    }
    if (older == ".csv" || older == ".npy") {
        refuse(fmt::format("--baseline: {}: the older result must be a .jsonl file", asked.baseline));
    }
    if (!asked.statuses.empty() && io::ending_of(asked.statuses) != ".json") {
        refuse(fmt::format("--statuses: {}: the name of the file must end in .json", asked.statuses));
    }
    const bool has_space = !asked.report.empty() || writes_bcf(request);
    if (!has_space && asked.space.up != io::UpAxis::unknown) refuse("--up: only with --report or an output in BCF");
    if (!has_space && !asked.space.unit.empty()) refuse("--unit: only with --report or an output in BCF");
    if (!asked.baseline.empty() && request.limit)
        refuse("--baseline: not with --limit, which may leave out new collisions");
}

}  // namespace

void check_search_options(const DetectRequest& request) {
    const std::optional<std::string> boxes = input_of_boxes(request);
    if (boxes && request.mesh_objects == io::MeshObjects::triangle)
        refuse(fmt::format("--objects triangle: {} has only boxes, no triangles", *boxes));
    check_exact_options(request);
    check_classes(request);
    io::check_relations("--exclude", request.pipeline.exclude);
    if (!has_filters(request)) return;
    const std::string asked = filter_option(request);
    if (!with_pipeline) refuse(asked + ": this octopair was built without the pipeline");
    if (request.wide_indices) refuse("--index-type uint64: not with " + asked);
    if (request.events) refuse(asked + ": not with --events");
    if (stage_of(request) == Stage::pairs) return;
    if (boxes) refuse(fmt::format("{}: {} has only boxes, no shapes; use --stage pairs", asked, *boxes));
}

void check_pipeline_options(const DetectRequest& request) {
    check_search_options(request);
    check_bcf_output(request);
    check_outcome_options(request);
}

}  // namespace octopair::cli
