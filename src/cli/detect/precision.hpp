// Precision of coordinates: the default tolerance, and warnings where coordinates are too coarse for a question.
#pragma once

#include <string>
#include <vector>

#include "cli/detect/filter_chain.hpp"

namespace octopair::cli {

/// Returns the tolerance of --tolerance. Without it: two steps of float32 at the largest coordinate, if coordinates of meshes were
/// rounded to float32; otherwise 0.
double tolerance_of(const DetectRequest& request, const SetPair& sets);

/// Returns warnings about coordinates: rounded in steps that are coarse against the scene or the tolerance, or with different
/// axes up. Requires: the sets are whole and have boxes.
std::vector<std::string> coordinate_warnings(const DetectRequest& request, const SetPair& sets);

}  // namespace octopair::cli
