// DetectReport: counts, times and warnings of a run of `octopair detect`. Also makes the summary for people and the statistics in JSON.
// Start here to change the summary and the statistics of detect.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/engine_choice.hpp"
#include "cli/input/input_set.hpp"
#include "io/loaded_scene.hpp"
#include "io/results/baseline.hpp"
#include "io/results/statuses.hpp"
#include "octopair/engine.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::cli {

/// Wall-clock seconds. `detect` excludes the time in filters and in writing; `filter` excludes the time in the search and in
/// writing.
struct DetectSeconds {
    double total = 0, read = 0;
    double prepare = 0;  ///< preparing shapes and filters, before the first search
    double detect = 0, filter = 0, write = 0;
    double verify = 0;  ///< 0 without --verify
};

/// Numbers of rows written.
struct EventCounts {
    std::uint64_t began = 0, ended = 0;
};

struct DetectReport {
    std::uint64_t objects = 0;  ///< number of objects of both sets in each frame
    std::uint64_t frames = 1;
    bool moving = false;
    std::uint64_t pairs = 0;  ///< pairs written or counted, of all frames
    bool truncated = false;
    bool verified = false;              ///< true if the pairs of boxes of each frame so far were checked
    bool collisions_verified = false;   ///< true if the collisions were checked by certificates, too
    std::string not_checked;            ///< text for users: properties that --verify did not check in some frame
    std::uint64_t candidates = 0;       ///< pairs of boxes that the search found before filters
    std::vector<FilterCounts> filters;  ///< counts of each filter, summed over all frames
    std::array<std::uint64_t, collision_classes> of_class = {};  ///< collisions by class, of all frames, if known
    std::optional<double> tolerance;                             ///< tolerance of the exact stages, as a length
    bool tolerance_is_default =
        false;         ///< true: the tolerance follows from the chord error and the error of rounding to float32
    double chord = 0;  ///< chord error of --chord, or of the readers; 0: none
    std::uint64_t open_objects = 0;            ///< objects whose geometry is not closed
    std::vector<std::string> first_open;       ///< names of the first open objects
    std::string unit;                          ///< unit of all lengths; empty if no input states one
    std::vector<Part> converted;               ///< the inputs whose coordinates were converted to this unit
    io::ElementCounts elements;                ///< elements of IFC models among the inputs
    std::vector<std::string> warnings;         ///< about the inputs, and about rules; each one line
    std::optional<io::ChangeCounts> changes;   ///< nothing without --baseline
    std::optional<io::StatusCounts> statuses;  ///< nothing without --statuses
    std::optional<EventCounts> events;  ///< nothing without --events; with it, `entries` and `steps` are not known
    std::uint64_t entries = 0;
    StepSeconds steps;
    DetectSeconds seconds;
    EngineDescription engine;

    /// Adds the counts and seconds of the call for a frame. `written`: seconds of the call that were spent in writing.
    void add(const Summary& summary, double written);
    void add(const PipelineSummary& summary, double written);
    void add_warnings(const std::vector<std::string>& added) {
        warnings.insert(warnings.end(), added.begin(), added.end());
    }
    /// Adds a property that a check did not cover. Empty: none.
    void add_not_checked(std::string_view what);

private:
    void add_search(const Summary& search);
    void add(const Verification& verification);
};

/// Returns the summary: several lines, each with a newline.
std::string summary_text(const DetectReport& report);

/// Returns the statistics: one JSON object (docs/formats.md) and a newline.
std::string stats_json(const DetectReport& report);

}  // namespace octopair::cli
