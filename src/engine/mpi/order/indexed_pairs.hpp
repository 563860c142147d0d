// Pairs of 64-bit indices: converts the pairs that a rank found, in its own object numbers, and sorts pairs over all ranks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

/// Appends the pairs of `found` to `pairs`, with `a` and `b` replaced by their indices. Requires: `pairs` is empty.
void name_pairs(const PairList& found, std::span<const std::uint64_t> a_indices,
                std::span<const std::uint64_t> b_indices, std::vector<Pair64>& pairs);

/// Collective. Replaces this rank's pairs by its piece of the ascending sequence of the pairs of all ranks.
/// Throws: as Agreement::together.
void sort_over_ranks(Communicator& comm, std::vector<Pair64>& pairs);

}  // namespace octopair
