// Pairs in doubt of ranks that received entries: after the scan, the ranks fetch the boxes of these pairs and decide.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/entries/known_boxes.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/pair_list.hpp"

namespace octopair {

/// Collective. Returns those of `postponed` that the pair rule refuses. `slices`: this rank's objects, by set. In a join, `b` of the
/// postponed pairs counts on from the first set; `b` of the result is a position in the second set.
/// Throws: as Agreement::together.
std::vector<PostponedPair> refused_pairs(Communicator& comm, const JointCall& call,
                                         const std::array<Objects, 2>& slices, std::vector<PostponedPair> postponed);

/// Removes pairs from a list. `removed`: pairs of the list, each once, in any order.
void remove_pairs(detail::PairStorage& list, std::vector<PostponedPair> removed);

}  // namespace octopair
