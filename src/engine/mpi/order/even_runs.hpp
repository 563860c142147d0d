// Sorting over ranks: which of the keys that each rank has in order belong to which rank.
#pragma once

#include <cstdint>
#include <span>

#include "engine/mpi/comm/communicator.hpp"

namespace octopair {

/// Collective. `keys`: this rank's, ascending. How many of them, from the first on, go to each rank, such that every rank gets
/// about equally many of all, none that is less than one of the rank before, and all that are equal. Throws as
/// Agreement::together.
RankCounts even_runs(Communicator& comm, std::span<const std::uint64_t> keys);

}  // namespace octopair
