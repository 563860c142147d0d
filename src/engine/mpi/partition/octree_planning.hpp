// Octree planning: all ranks together choose the octants of the octree, from a sample of which each rank has a part.
//
//   space   each of the nine measures that the space is fitted to is computed on one rank
//   top     all ranks split the octants with a large part of the sample, level by level: each rank counts its part of the
//           sample, and the sums decide
//   rest    the remaining octants are assigned to ranks, in runs of the pre-order with about equally many boxes of the sample;
//           each rank grows its subtrees
//
// Result     the shapes of all subtrees, in pre-order, give the shape of the whole octree. All ranks gather this shape. It
//            equals the octree that the local engine grows from the same sample.
#pragma once

#include <stop_token>

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

/// Collective. Returns the space and the octants of the octree. `own`: this rank's objects. Throws: as Agreement::together.
OctreeLayout plan_together(Communicator& comm, const JointCall& call, const BoxSource& own,
                           const std::stop_token& stop);

}  // namespace octopair
