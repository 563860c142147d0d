// Pairs of indices of 64 bits: what a rank finds in numbers of its own becomes its piece of the pairs of all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

/// The pairs of `found`, whose `a` and `b` are called so; `pairs` is empty before.
void name_pairs(const PairList& found, std::span<const std::uint64_t> a_indices,
                std::span<const std::uint64_t> b_indices, std::vector<Pair64>& pairs);

/// Collective: this rank's pairs become its piece of the ascending sequence of all. Throws as Agreement::together.
void sort_over_ranks(Communicator& comm, std::vector<Pair64>& pairs);

}  // namespace octopair
