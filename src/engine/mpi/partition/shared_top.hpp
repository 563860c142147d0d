// SharedTop: the octants at the top of the octree, which all ranks divide together and store.
//
// The ranks divide octants level by level. Each rank counts its own part of the sample, and the sums over all ranks decide. An
// octant is "left" when it has few boxes of the sample, or is not worth dividing. One rank grows the subtree of a left octant alone.
//
// Invariants 1. The octants and their states are the same on all ranks.
//            2. The octree that the local engine grows from the same sample has all octants of the shared top. There, only left
//               octants may be divided further.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/octree_plan.hpp"

namespace octopair {

class SharedTop {
public:
    /// A box of this rank's part of the sample that touches a left octant.
    struct SampledBox {
        OctantIndex octant;  ///< the left octant, in pre-order of the shared top
        std::uint32_t box;   ///< number of the box in this rank's part of the sample
        bool kept;           ///< the entry is kept by the octant or by an ancestor
    };
    struct SharedOctant {
        OctantCube octant;
        bool left;  ///< a leaf of the shared top
        std::uint32_t
            boxes;  ///< number of boxes of the sample, of all ranks, that touch the octant and are not handed down below
        // Means over the sampled boxes that touch the octant.
        double shortest;  ///< extent on the shortest axis, in sides of the octant
        double overlap;   ///< estimated fraction of the octant's boxes that one of its boxes overlaps
    };

    /// Collective. Divides octants until each one has at most `most` boxes of the sample, or is not to be divided. `own`: cells
    /// of this rank's part of the sample. Throws: as Agreement::together.
    SharedTop(Communicator& comm, const SplitRule& growth, std::uint64_t most, std::span<const CellBox> own);

    /// Returns the shape of the shared top. Its leaves are the left octants.
    const SplitFlags& shape() const { return shape_; }
    /// Returns the octants of the shared top, in pre-order.
    std::span<const SharedOctant> octants() const { return octants_; }
    /// Returns this rank's sampled boxes, once for each left octant that they touch.
    std::span<const SampledBox> boxes() const { return boxes_; }

private:
    class Growth;

    SplitFlags shape_;
    std::vector<SharedOctant> octants_;
    std::vector<SampledBox> boxes_;
};

}  // namespace octopair
