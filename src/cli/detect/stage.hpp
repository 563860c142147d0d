// How far down the pipeline a run goes, and which of its options go with that.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/filters.hpp"

namespace octopair::cli {

class Command;

struct DetectRequest;

enum class Stage : std::uint8_t { pairs, objects, features };

/// What is asked of the pipeline; left out where the default is meant.
struct PipelineRequest {
    std::optional<Stage> stage;
    std::string exclude;  ///< a file of exclusion rules, or empty
    std::optional<bool> same_parent;
    std::optional<AdjacentTriangles> adjacent;
    std::optional<std::uint32_t> max_contacts;
    std::string baseline;  ///< an older result, or empty
    std::string report;    ///< where a page for people goes, or empty
};

/// Those of this program, as --stage names them.
std::vector<std::string_view> stage_names();

/// --stage, --adjacent, --max-contacts, --exclude, --same-parent, --baseline, --report.
void add_pipeline_options(Command& command, PipelineRequest& request);

/// The one that was asked for; else `objects` where all inputs have shapes and this program has a pipeline for them, and
/// `pairs` where not.
Stage stage_of(const DetectRequest& request);

/// Whether pairs are to go through filters.
bool has_filters(const DetectRequest& request);

/// Throws Error{usage} for what does not go together.
void check_pipeline_options(const DetectRequest& request);

}  // namespace octopair::cli
