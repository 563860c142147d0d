// Owners of octants if the objects of each rank are near each other, as in a simulation whose ranks own regions of space. Then most octants
// stay with the rank that has most of their entries, so few entries are sent.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/partition/octant_owners.hpp"

namespace octopair {

/// Estimated work and numbers of entries, by octant.
struct OctantLoads {
    std::span<const std::uint32_t> own, all;  ///< entries of this rank and of all ranks
    std::span<const std::uint64_t> work;      ///< work on the entries of all ranks
};

/// Collective. Returns none if the objects of a rank are not near each other. The result is the same on all ranks, and depends only on the
/// arguments of all ranks.
std::optional<OctantOwners> regional_owners(Communicator& comm, const OctantLoads& loads);

}  // namespace octopair
