// Boxes of .csv files: six numbers a line, separated by commas, as float64.
//
// The numbers are those of std::from_chars (so of no locale), with an optional plus sign; spaces and tabs may stand
// around them. Lines end with '\n' or "\r\n"; blank lines are passed over. The first line is a header if it has six
// fields and none of them is a number.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>

#include "base/memory.hpp"
#include "io/loaded_scene.hpp"

namespace octopair::io {

/// Throws Error{bad_input} that names `file` and the line; Error{cancelled} soon after a stop request.
Buffer<Box3d> parse_csv_boxes(std::string_view text, std::string_view file, const std::stop_token& stop = {});

/// Throws as parse_csv_boxes does, and Error{io_failed}.
LoadedScene read_csv_scene(const std::string& path, const std::stop_token& stop = {});

}  // namespace octopair::io
