// Runs `octopair detect --events`: writes the pairs that begin and end from frame to frame.
//
// Result    The differences between the full results of consecutive frames. For each frame, the pairs that ended come first,
//           then the pairs that began, each ascending. Before the first frame there are no pairs.
// Memory    Two frames and a scene, or one frame and the pairs of two frames (event_source.hpp).
#pragma once

#include "cli/detect/detection.hpp"

namespace octopair::cli {

/// Throws: Error{usage} for options, and formats of --output, that --events excludes.
void check_event_options(const DetectRequest& request);

/// Reads the inputs, finds the events, and writes the result. The caller writes the statistics. Throws: Error.
DetectReport detect_events(const DetectRequest& request, const std::stop_token& stop);

}  // namespace octopair::cli
