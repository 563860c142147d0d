// Table of all file formats that octopair knows: the reader of each format, and the change that Assimp makes to its axes.
//
// A new format is one line of format_table.cpp. If its files begin with a mark, content_marks.cpp has a line for the mark, too.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace octopair::io {

/// The reader of the files of a format.
enum class FormatReader : std::uint8_t {
    octopair,        ///< a reader of octopair
    checked_assimp,  ///< Assimp; octopair compares the result with the file
    assimp,          ///< Assimp; octopair does not check the result, and warns about this
    program,         ///< an optional program; without it, files are refused (meshes/stream/reader_program.hpp)
    nobody,          ///< files are refused; FileFormat::remedy says what to do
};

/// Change that Assimp makes to the coordinates of a file. octopair reverts it without rounding.
enum class AxisChange : std::uint8_t {
    none,
    turned,    ///< (x, y, z) becomes (x, z, -y), in the transform of the root
    mirrored,  ///< (x, y, z) becomes (x, y, -z), in vertices and transforms
};

struct FileFormat {
    std::string_view name;  ///< for messages
    /// Endings of names in lower case, with their dots, separated by spaces. The first one names the format (format_ending()).
    std::string_view endings;
    FormatReader reader;
    AxisChange axes;
    std::string_view remedy;  ///< for formats that nobody or a program reads: what to do without it

    /// Returns the first ending; empty if no ending is known.
    std::string_view first_ending() const { return endings.substr(0, endings.find(' ')); }
    bool has_ending(std::string_view ending) const;
};

std::span<const FileFormat> file_formats();

/// Returns the format of an ending, or null if the table does not have it. Requires: `ending` is in lower case, with its dot.
const FileFormat* format_with_ending(std::string_view ending);

}  // namespace octopair::io
