// The ranks of MPI as a group that searches together (frame_search.hpp): each rank reads its slice of the inputs, and all compare what
// they have read.
#pragma once

#include <memory>

#include "cli/detect/frame_search.hpp"
#include "cli/ranks/cluster.hpp"

namespace octopair::cli {

/// Returns the options that must be equal on all ranks. --threads, --quiet and the paths of inputs may differ: hosts may have their
/// files in different folders.
Facts option_facts(const DetectRequest& request);

/// Borrows `cluster`.
std::unique_ptr<SearchGroup> ranks_of(Cluster& cluster);

// For the search of ranks (rank_search.cpp).

/// Returns whether indices need more bits than a Pair has, or if the request asks for 64 bits.
bool has_wide_indices(const DetectRun& run);

/// Returns whether every rank must read all objects instead of its slice. Filters and verification may need any object, and the boxes
/// of some shapes (planes) depend on all objects.
bool needs_whole_inputs(const DetectRequest& request);

/// Returns the slice of each set that this rank gives to the engine.
SliceNumber own_slice(const Cluster& cluster);

/// Collective. Borrows both. Throws: what make_mpi_engine() throws.
std::unique_ptr<FrameSearch> make_ranked_search(DetectRun& run, Cluster& cluster);

}  // namespace octopair::cli
