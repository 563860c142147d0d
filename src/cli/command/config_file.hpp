// Reads options of a subcommand from a file. A line `NAME = VALUE` sets the option --NAME.
//
// The form is a part of TOML: a value is a string in quotes without escapes, or a word (TOML would want quotes around some words). Each
// line is such a line, empty, or a comment after '#'. Anything else is refused: CLI11's reader accepts most files with a slip, and then
// sets other options than their author meant.
#pragma once

#include <string>

#include "cli/command/command.hpp"

namespace octopair::cli {

/// Sets the options of `file` that the command line does not set. Requires: `command` was parsed.
/// Throws: Error{usage} that names the file, and the option or the line; Error{io_failed, bad_input} if the file cannot be read.
void apply_config(const Command& command, const std::string& file);

}  // namespace octopair::cli
