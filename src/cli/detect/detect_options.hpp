// The options of `octopair detect`. Those of filters and exact stages are in pipeline_options.hpp. `octopair submit` shares the
// options of the scene, and of the order and number of pairs.
// Start here to add a new option of detect.
#pragma once

#include <string>

#include "cli/command/command.hpp"
#include "cli/detect/detection.hpp"

namespace octopair::cli {

/// Adds --output. `formats`: the endings of its formats, for the help.
Option add_output_option(Command& command, std::string& output, const char* formats);

/// Adds INPUT, --against, --objects, --margin and --padding, in the sections "Input" and "What counts". `inputs` is the help text of INPUT.
void add_scene_options(Command& command, DetectRequest& request, const std::string& inputs);

/// Adds --order and --limit. `limited` is the help text of --limit.
void add_order_options(Command& command, DetectRequest& request, const std::string& limited);

/// Adds all options of `octopair detect`.
void add_detect_options(Command& command, DetectRequest& request);

/// Throws: Error{usage} for options that cannot be used together.
void check_detect_options(DetectRequest& request);

}  // namespace octopair::cli
