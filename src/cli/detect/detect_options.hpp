// The options that say what is looked for, of every subcommand that finds pairs or has them found.
#pragma once

#include "cli/detect/detection.hpp"

namespace octopair::cli {

class Command;

/// INPUT, --against, --objects, --margin, --padding.
void add_scene_options(Command& command, DetectRequest& request);

/// --order, --limit. `limited`: what the limit counts.
void add_order_options(Command& command, DetectRequest& request, const std::string& limited);

}  // namespace octopair::cli
