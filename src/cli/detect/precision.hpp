// Precision of coordinates: the default tolerance, and warnings where coordinates are too coarse for a question.
#pragma once

#include <string>
#include <vector>

#include "cli/detect/filter_chain.hpp"

namespace octopair::cli {

/// Returns the tolerance of --tolerance. Without it: 2^-22 of the largest coordinate that was rounded to float32 (LoadedScene), which is two
/// to four steps of float32 there; 0 if none was.
double tolerance_of(const DetectRequest& request, const SetPair& sets);

/// Returns warnings about coordinates: rounded in steps that are coarse against the scene or the tolerance, or with different
/// axes up. Requires: the sets are whole and have boxes.
std::vector<std::string> coordinate_warnings(const DetectRequest& request, const SetPair& sets);

}  // namespace octopair::cli
