// `octopair detect --engine mpi`: each rank reads its slice of the inputs, and writes its piece of the pairs.
#pragma once

#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/ranks/cluster.hpp"

namespace octopair::cli {

/// Collective. Does it all but what the first rank says of it. Throws Error, on all ranks the same.
DetectReport detect_on_ranks(const DetectRequest& request, Cluster& cluster, const std::stop_token& stop);

}  // namespace octopair::cli
