// `octopair detect`, from files to files.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "cli/command/command.hpp"
#include "cli/detect/detect_report.hpp"
#include "cli/detect/pipeline_options.hpp"
#include "cli/engine_choice.hpp"
#include "io/scene_reader.hpp"
#include "octopair/engine.hpp"

namespace octopair::cli {

class SearchGroup;

struct DetectRequest {
    std::vector<std::string> inputs;
    std::string against;  ///< empty: pairs within the inputs
    io::MeshObjects mesh_objects = io::MeshObjects::node;
    io::ReaderChoice reader = {};
    std::string padding;  ///< a file, or empty
    std::string output;   ///< a file, or empty for standard output
    double margin = 0;
    Order order = Order::ascending;
    std::optional<std::uint64_t> limit;
    bool count_only = false;
    bool fail_on_collision = false;
    bool events = false;
    bool verify = false;  ///< true: check pairs of boxes by a second algorithm, and collisions by certificates
    PipelineRequest pipeline;
    bool wide_indices = false;  ///< true: write indices as uint64 into .npy files
    EngineChoice engine;
    std::string stats;  ///< a file, or empty
    bool quiet = false;
    std::vector<GivenOption> given;  ///< all given options as texts; the ranks compare them with each other
};

/// Returns the reader of the inputs, with the chord error of --chord.
io::ReaderChoice reader_of(const DetectRequest& request);

/// Finds the pairs of a request, on the processes of a group, and writes them.
/// Collective. Throws: Error, the same on all ranks.
/// Returns the report: counts summed over all ranks, and the seconds that this rank has measured.
DetectReport detect(const DetectRequest& request, SearchGroup& searchers, const std::stop_token& stop);

}  // namespace octopair::cli
