// A subcommand's options in a file (TOML, or INI without sections): a line `NAME = VALUE` is the option --NAME.
#pragma once

#include <string>

#include "cli/command/command.hpp"

namespace octopair::cli {

/// Gives `command`, which was parsed, those options of the file that the command line does not have. Throws Error{usage}
/// that names the file and the key, Error{io_failed} if it cannot be read.
void apply_config(const Command& command, const std::string& file);

}  // namespace octopair::cli
