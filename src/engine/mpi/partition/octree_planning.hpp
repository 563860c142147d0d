// Planting: the octants of an octree grown by all ranks together, from a sample of which each rank has a part.
//
//   space   each of the nine numbers that it is fitted to is measured on one rank
//   top     octants with much of the sample are divided by all ranks, level by level: each counts its part, and the sums
//           decide
//   rest    the octants below are dealt out in runs of the pre-order with about as many boxes of the sample; each rank grows
//           its own
// The shapes of all, in pre-order, are that of the whole tree, which every rank then knows: the tree that the local engine
// grows from the same sample.
#pragma once

#include <stop_token>

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

/// Collective. `own`: this rank's objects. Throws as Agreement::together.
OctreeLayout plan_together(Communicator& comm, const JointCall& call, const BoxSource& own,
                              const std::stop_token& stop);

}  // namespace octopair
