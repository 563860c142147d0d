// The tolerance of touching: that of --tolerance, or the precision of the coordinates.
#pragma once

#include "cli/detect/filter_chain.hpp"

namespace octopair::cli {

/// Returns the tolerance of --tolerance. Without it: 2^-22 of the largest coordinate that was rounded to float32 (LoadedScene), which is two
/// to four steps of float32 there; 0 if none was.
double tolerance_of(const DetectRequest& request, const SetPair& sets);

}  // namespace octopair::cli
