// program_main: runs a program's work, and reports its errors as one line and an exit status.
#pragma once

#include <functional>

namespace octopair::cli {

/// The work of a subcommand. Returns the exit status. May throw.
using Action = std::function<int()>;

/// Runs `run`, and returns its exit status. An exception becomes one line on standard error, which begins with `program`, and
/// the exit status of its error code. A closed pipe and a file-size limit make write() fail, and do not end the program.
/// Call once, from main(). `program`: a text that lives until the end.
int program_main(const char* program, const Action& run);

}  // namespace octopair::cli
