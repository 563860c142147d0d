// OctreePlanning: the ranks choose the octants of the octree together, from a sample of which each rank has a part.
//
//   space   each of the nine measures that the space is fitted to is computed on one rank
//   top     all ranks divide the octants with a large part of the sample                            (shared_top.hpp)
//   rest    each rank receives the sampled boxes in its own octants, and grows the subtrees there
//
// Invariants 1. A rank stores the shared top and the subtrees of its own octants. No rank stores the whole octree.
//            2. The own octants of all ranks, in rank order, are the octants that the local engine grows from the same sample.
//            3. A box has the same entries in an octant, however far other octants are divided. So the entries of a rank's own
//               octants, and the pairs found there, are those of the whole octree.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/octant_owners.hpp"
#include "engine/mpi/partition/shared_top.hpp"
#include "octree/build/linear_octree.hpp"

namespace octopair {

class OctreePlanning {
public:
    /// Collective. Chooses the space and the shared top. `own`: this rank's objects. Borrows `comm`.
    /// Throws: as Agreement::together.
    OctreePlanning(Communicator& comm, const JointCall& call, const BoxSource& own, std::stop_token stop);
    OctreePlanning(const OctreePlanning&) = delete;
    OctreePlanning& operator=(const OctreePlanning&) = delete;

    /// Returns the space and the octants of the shared top.
    const OctreeLayout& shared() const { return shared_; }

    const SharedTop& top() const { return *top_; }

    /// The octants that a rank stores. It owns the octants [begin, end).
    struct OwnLayout {
        OctreeLayout layout;
        OctantIndex begin = 0, end = 0;
    };
    /// Collective. Divides the octants that this rank owns. `owners`: of the octants of the shared top.
    /// Throws: as Agreement::together.
    OwnLayout grow(const OctantOwners& owners);

private:
    Communicator& comm_;
    SplitRule growth_;
    std::stop_token stop_;
    OctreeLayout shared_;
    std::vector<CellBox> sampled_;  // this rank's part of the sample
    std::optional<SharedTop> top_;
};

}  // namespace octopair
