// Warnings about the inputs: those of their readers, inputs without objects, coarse coordinates, and different axes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/detect/detection.hpp"
#include "cli/input/input_set.hpp"

namespace octopair::cli {

/// Returns the warnings about the inputs, each one line. Coordinates are coarse if they were rounded to float32 in steps that are large
/// against the scene or the tolerance. Requires: the sets are whole and have boxes.
std::vector<std::string> input_warnings(const DetectRequest& request, const SetPair& sets);

/// For --fail-on-collision: a check of nothing must not pass. Throws: Error{bad_input} that names a file without objects.
void refuse_empty_parts(std::span<const Part> parts);

}  // namespace octopair::cli
