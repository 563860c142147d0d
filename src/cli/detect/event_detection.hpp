// Runs `octopair detect --events`: writes the pairs that begin and end from frame to frame.
//
// Result    The differences between the full results of consecutive frames. For each frame, the pairs that ended come first,
//           then the pairs that began, each ascending. Before the first frame there are no pairs.
// Memory    Two frames and a scene, or one frame and the pairs of two frames (event_source.hpp).
#pragma once

#include <memory>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "octopair/engine.hpp"

namespace octopair::cli {

/// Throws: Error{usage} for options, and formats of --output, that --events excludes.
void check_event_options(const DetectRequest& request);

/// An engine that has ranks.
struct RankedEngine {
    std::unique_ptr<Engine> engine;
    unsigned ranks;
};

/// Reads the inputs, finds the events, and writes the result. The caller writes the statistics. `ranked`: finds the pairs, if it
/// has an engine; otherwise an engine is made as the request says. Throws: Error.
DetectReport detect_events(const DetectRequest& request, RankedEngine ranked, const std::stop_token& stop);

}  // namespace octopair::cli
