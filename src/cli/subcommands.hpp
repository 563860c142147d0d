// Subcommands of octopair. Each function adds one subcommand to the parser. Its callback sets `action`, which runs after
// parsing and returns the exit status. Callbacks and actions may throw Error.
// Start here to add a new subcommand.
#pragma once

#include "cli/command/command.hpp"
#include "cli/command/program_main.hpp"

namespace octopair::cli {

void add_cancel(Command& program, Action& action);
void add_drain(Command& program, Action& action);
void add_detect(Command& program, Action& action);
void add_generate(Command& program, Action& action);
void add_info(Command& program, Action& action);
void add_replay(Command& program, Action& action);
void add_result(Command& program, Action& action);
void add_serve(Command& program, Action& action);
void add_status(Command& program, Action& action);
void add_submit(Command& program, Action& action);
void add_view(Command& program, Action& action);

}  // namespace octopair::cli
