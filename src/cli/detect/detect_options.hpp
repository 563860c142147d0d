// The options of `octopair detect`. Those of filters and exact stages are in pipeline_options.hpp. `octopair submit` shares the
// options of the scene, and of the order and number of pairs.
// Start here to add a new option of detect.
#pragma once

#include "cli/detect/detection.hpp"

namespace octopair::cli {

class Command;

/// Adds --objects and --margin.
void add_box_options(Command& command, DetectRequest& request);

/// Adds INPUT, --against, --objects, --margin and --padding.
void add_scene_options(Command& command, DetectRequest& request);

/// Adds --order and --limit. `limited` is the help text of --limit.
void add_order_options(Command& command, DetectRequest& request, const std::string& limited);

/// Adds all options of `octopair detect`.
void add_detect_options(Command& command, DetectRequest& request);

/// Throws: Error{usage} for options that cannot be used together.
void check_detect_options(DetectRequest& request);

}  // namespace octopair::cli
