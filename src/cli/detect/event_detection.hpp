// `octopair detect --events`: the pairs that begin and end from frame to frame.
//
// Result    what the frames' full results differ in, frame by frame: first what ended, then what began, each ascending.
//           Before the first frame there are no pairs.
// Memory    two frames and a scene, or a frame and the pairs of two (event_source.hpp).
#pragma once

#include "cli/detect/detection.hpp"

namespace octopair::cli {

/// Throws Error{usage} for options that events cannot be had with.
void check_event_options(const DetectRequest& request);

/// Does it all but the stats. Throws Error.
DetectReport detect_events(const DetectRequest& request, const std::stop_token& stop);

}  // namespace octopair::cli
