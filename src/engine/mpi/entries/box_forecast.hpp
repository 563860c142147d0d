// Forecast of the boxes that a scan of received entries will need: those of entries that are handed down, and of octants that may be too
// crowded for a sweep on cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mpi/entries/inner_entries.hpp"
#include "engine/mpi/joint_call.hpp"
#include "octree/scan/scan.hpp"

namespace octopair {

/// Positions of objects, by set; ascending, each once.
using WantedObjects = std::array<std::vector<std::uint32_t>, 2>;

/// Returns the objects whose boxes a scan of `octants` will probably need. `inner`: the entries of inner octants.
WantedObjects forecast_boxes(const JointCall& call, const OctreeRange& octants, const InnerEntries& inner);

}  // namespace octopair
