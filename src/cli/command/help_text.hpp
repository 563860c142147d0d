// Help: the content of --help, and its layout in lines that fit the terminal.
//
// The formatter of CLI11 is not used: in version 2.1 of Debian 12 it never breaks a line. Later versions have fixed widths, not that of the
// terminal, and no examples.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace octopair::cli {

/// An option with its value, an argument, a subcommand, or another word, and what it means.
struct HelpEntry {
    std::string name, text;
};

struct HelpSection {
    std::string title;
    std::vector<HelpEntry> entries;
};

struct Help {
    std::string description;
    std::string command;  ///< program and subcommand, for the usage
    std::string usage;    ///< what follows the command
    std::vector<HelpSection> sections;
    std::vector<std::string> examples;  ///< command lines, which are not wrapped
    std::string more;                   ///< last line, or empty
};

/// Returns the help in lines of at most `width` characters. Breaks lines only between words, and never within an example.
/// Descriptions stand in one column; a name that is too long for the first column has a line of its own.
std::string help_text(const Help& help, std::size_t width);

/// Returns the width for help_text(): the columns of the terminal at standard output, otherwise of the environment variable
/// COLUMNS, otherwise 80. It is from 40 to 100.
std::size_t help_width();

}  // namespace octopair::cli
