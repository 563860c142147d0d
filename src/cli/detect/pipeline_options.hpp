// The options of `octopair detect` for filters and exact stages. Stage: the last step of the pipeline that a run takes.
#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/format_choice.hpp"
#include "octopair/filters.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

class Command;
struct DetectRequest;
struct SetPair;

enum class Stage : std::uint8_t { pairs, objects, features };

/// Classes of collisions, by CollisionClass.
using ClassSet = std::bitset<collision_classes>;

/// Options of the pipeline. A member without a value means the default.
struct PipelineRequest {
    std::optional<Stage> stage;
    std::string exclude;  ///< path of exclusion rules, or empty
    std::optional<bool> same_parent;
    std::optional<AdjacentTriangles> adjacent;
    std::optional<std::uint32_t> max_contacts;
    std::optional<double> tolerance, duplicate_tolerance, chord, min_depth, weld;
    std::optional<ClassSet> classes;  ///< classes of the rows
    std::string baseline;             ///< path of an older result, or empty
    std::string statuses;             ///< path of the file of statuses to read and write, or empty
    std::string report;               ///< path of the HTML report to write, or empty
    io::SceneSpace space;  ///< axis up and unit for the report; unknown: the report uses those of the input formats
};

/// Returns the stages of this build, by their names for --stage.
std::vector<std::string_view> stage_names();

/// Returns the words of classes, with commas: the value of --classes in a fixed order.
std::string class_list(const ClassSet& classes);

/// Add --stage, --up and --unit. `description` is the help text.
void add_stage_option(Command& command, PipelineRequest& request, const std::string& description);
void add_up_option(Command& command, PipelineRequest& request, const std::string& description);
void add_unit_option(Command& command, PipelineRequest& request, const std::string& description);

/// Adds --stage, --exclude and --same-parent. `description` is the help text of --stage.
void add_stage_options(Command& command, PipelineRequest& request, const std::string& description);

/// Adds the options of the exact stages: --adjacent, --max-contacts, --tolerance, --duplicate-tolerance, --min-depth, --classes
/// and --weld.
void add_exact_options(Command& command, PipelineRequest& request);

/// Adds --baseline, --statuses, --report, --up and --unit.
void add_report_options(Command& command, PipelineRequest& request);

/// Returns the stage of --stage. Without it, returns `objects` if all inputs have shapes, this build has the pipeline, and the
/// request has no --events; otherwise `pairs`.
Stage stage_of(const DetectRequest& request);

/// Returns the first input without shapes, or nothing if all inputs have shapes.
std::optional<std::string> input_of_boxes(const DetectRequest& request);

/// Returns the greatest chord error: of --chord, and of what the readers know.
double chord_of(const DetectRequest& request, const SetPair& sets);

/// Returns the tolerance without --tolerance: twice the chord error, because both surfaces of an overlap may err; plus the error of rounding.
/// The error of rounding is 2^-22 of the largest coordinate that was rounded to float32 (LoadedScene), which is two to four steps of float32 at this
/// coordinate. It is 0 if no coordinate was rounded.
double default_tolerance_of(const DetectRequest& request, const SetPair& sets);

/// Returns the value of --tolerance, or the default.
double tolerance_of(const DetectRequest& request, const SetPair& sets);

/// Returns whether the request needs filters.
bool has_filters(const DetectRequest& request);

/// Throws: Error{usage} for options of the search that do not fit together.
void check_search_options(const DetectRequest& request);
/// Throws: as check_search_options(), also for --baseline, --report, --up and --unit.
void check_pipeline_options(const DetectRequest& request);

}  // namespace octopair::cli
