// Reads options of a subcommand from a file (TOML, or INI without sections). A line `NAME = VALUE` sets the option --NAME.
#pragma once

#include <string>

#include "cli/command/command.hpp"

namespace octopair::cli {

/// Sets the options of `file` that the command line does not set. Requires: `command` was parsed.
/// Throws: Error{usage} that names the file and the key; Error{io_failed} if the file cannot be read.
void apply_config(const Command& command, const std::string& file);

}  // namespace octopair::cli
