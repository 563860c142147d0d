// Options that `octopair detect` and `octopair submit` share: the scene, and the order and number of pairs.
#pragma once

#include "cli/detect/detection.hpp"

namespace octopair::cli {

class Command;

/// Adds INPUT, --against, --objects, --margin and --padding.
void add_scene_options(Command& command, DetectRequest& request);

/// Adds --order and --limit. `limited` is the help text of --limit.
void add_order_options(Command& command, DetectRequest& request, const std::string& limited);

}  // namespace octopair::cli
