// Splitters for a sample sort over ranks: they divide the sorted keys of each rank into one run for each rank.
#pragma once

#include <cstdint>
#include <span>

#include "engine/mpi/comm/communicator.hpp"

namespace octopair {

/// Collective. `keys`: keys of this rank, ascending. Returns how many of them go to each rank, in order from the first key.
/// All ranks get about equally many keys. A rank gets no key less than a key of the rank before. Equal keys go to one rank.
/// Throws: as Agreement::together.
RankCounts even_runs(Communicator& comm, std::span<const std::uint64_t> keys);

}  // namespace octopair
