// Reads boxes from .csv files: six float64 numbers per line, separated by commas.
//
// - Numbers have the syntax of std::from_chars (independent of the locale), with an optional plus sign. The exponent may begin with D.
// - Fields may be in quotes, as RFC 4180 describes. Spaces and tabs around a number are ignored.
// - Lines end with LF, CR LF or CR. Blank lines are ignored.
// - The first line is a header if it has six fields, of which some are not empty and none resembles a number.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>

#include "base/memory.hpp"
#include "io/loaded_scene.hpp"

namespace octopair::io {

/// Parses boxes. Throws: Error{bad_input} that names `file` and the line; Error{cancelled} soon after a stop request.
Buffer<Box3d> parse_csv_boxes(std::string_view text, std::string_view file, const std::stop_token& stop = {});

/// Reads a file. Throws: what parse_csv_boxes() throws; Error{io_failed}.
LoadedScene read_csv_scene(const std::string& path, const std::stop_token& stop = {});

}  // namespace octopair::io
