// program_main: runs a program, and reports an exception as one line on standard error and an exit status.
#pragma once

#include <functional>

namespace octopair::cli {

/// The work of a subcommand. Returns the exit status. May throw.
using Action = std::function<int()>;

/// Calls `run`, and returns its exit status. An exception becomes one line on standard error, which begins with `program`, and
/// the exit status of its error code. SIGPIPE and SIGXFSZ are ignored, so that write() fails instead of ending the program.
/// Requires: called once, from main(); `program` lives until the program ends.
int program_main(const char* program, const Action& run);

}  // namespace octopair::cli
