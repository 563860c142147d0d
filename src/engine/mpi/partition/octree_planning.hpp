// OctreePlanning: the ranks choose the octants of the octree together, from a sample of which each rank has a part.
//
//   space   each of the nine measures that the space is fitted to is computed on one rank
//   top     all ranks divide the octants with a large part of the sample                            (shared_top.hpp)
//   grow    each rank receives the sampled boxes in some octants of the top, and grows the subtrees there
//   share   all ranks receive all subtrees; or, if the octree is too large for that, no rank receives any
//
// Invariants 1. The octants are those that the local engine grows from the same sample.
//            2. If the octree is not whole(), a rank stores the shared top and the subtrees that it has grown. It owns these subtrees.
//            3. A box has the same entries in an octant, however far other octants are divided. So the entries of a rank's own
//               octants, and the pairs found there, are those of the whole octree.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/octant_owners.hpp"
#include "engine/mpi/partition/shared_top.hpp"
#include "octree/build/linear_octree.hpp"

namespace octopair {

/// Estimates by which the work in an octant is computed from the number of its entries.
struct OctantEstimate {
    double shortest;    ///< mean extent of a box on the shortest axis, in sides of the octant
    double overlap;     ///< fraction of the octant's boxes that a box overlaps
    double most_tests;  ///< maximum number of others that a sweep tests an entry against

    /// Returns the work. One unit is the work on an entry that no other entry is tested against. A sweep tests each entry against the
    /// entries that overlap it on the sweep's axis.
    std::uint64_t work(double entries) const;
};

struct SentBox;

class OctreePlanning {
public:
    /// Collective. Chooses the octree. `own`: this rank's objects. Borrows `comm`.
    /// Throws: as Agreement::together.
    OctreePlanning(Communicator& comm, const JointCall& call, const BoxSource& own, std::stop_token stop);
    OctreePlanning(const OctreePlanning&) = delete;
    OctreePlanning& operator=(const OctreePlanning&) = delete;

    /// True if all ranks store the whole octree.
    bool whole() const { return whole_; }
    /// True if scans will need the coordinates of many boxes: octants are too crowded for a sweep on cells, or so small that
    /// float32 coordinates in them are few. The same on all ranks.
    bool needs_coordinates() const { return needs_coordinates_; }
    /// Returns the space and the octants that all ranks store: the whole octree, or the shared top.
    const OctreeLayout& shared() const { return shared_; }
    /// Returns the same. Afterwards, shared() is empty.
    OctreeLayout take_shared() { return std::move(shared_); }

    /// Returns the estimated work in each octant that all ranks store.
    std::vector<std::uint64_t> work(std::span<const std::uint32_t> entries) const;
    /// Divides the octants that all ranks store among the ranks, one run for each. `entries`: number of entries of each octant, of all
    /// ranks. Another unit changes only the balance. An octree that is not whole is divided without these numbers.
    OctantOwners owners(std::span<const std::uint32_t> entries) const;

    /// The octants that a rank stores. It owns the octants [begin, end).
    struct OwnLayout {
        OctreeLayout layout;
        OctantIndex begin = 0, end = 0;
    };
    /// Returns the octants that this rank stores. `owners`: the result of owners(). Afterwards, shared() is empty.
    OwnLayout take_own(const OctantOwners& owners);

private:
    static constexpr double infinite = std::numeric_limits<double>::infinity();

    /// A leaf with too many objects for one octant that is not worth dividing.
    struct Crowd {
        OctantIndex octant;  // place among the octants of the rank that has grown it
        float shortest, overlap;
    };
    Crowd crowd_of(const SampledOctant& leaf, std::size_t place) const;
    /// Octants that a rank has grown.
    struct Grown {
        SplitFlags shape;
        std::vector<Crowd> crowds;
        bool needs_coordinates = false;  // an octant is probably too crowded for a sweep on cells
    };
    bool is_shared(std::uint64_t octants) const;
    std::uint64_t estimated_octants() const;
    void estimate(const SharedTop& top);
    std::vector<SentBox> exchange_boxes(const SharedTop& top, std::span<const CellBox> cells);
    Grown grow(const SharedTop& top, std::span<const SentBox> boxes) const;
    void share(const SharedTop& top, Grown grown);
    void refine(const SharedTop& top);
    static unsigned first_fine_level(const Space& space, bool exact);

    Communicator& comm_;
    std::uint64_t objects_;
    SplitRule growth_;
    bool exact_;  // boxes are not rounded
    std::stop_token stop_;
    Space space_;
    std::vector<OctantEstimate> estimates_;  // by octant of shared_
    OctantOwners growers_;                   // of the octants of the shared top
    bool whole_ = false, needs_coordinates_ = false;
    OctreeLayout shared_;
    OwnLayout own_;  // only unless whole_
};

}  // namespace octopair
