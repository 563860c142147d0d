// Subcommands of octopair-bench, one source file each. Each function adds a subcommand, whose callback sets `action`.
// `action` runs after parsing, measures, and returns the exit status. Both may throw Error.
#pragma once

#include "cli/command/command.hpp"
#include "cli/command/program_main.hpp"

namespace octopair::bench {

using cli::Action;
using cli::Command;

void add_cluster(Command& program, Action& action);
void add_paper(Command& program, Action& action);
void add_scaling(Command& program, Action& action);

}  // namespace octopair::bench
