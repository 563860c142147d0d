// Routing: prepares the objects of a rank for sending to the ranks that own their octants.
//
//   find_homes     finds the home leaf of each object, and the load that this rank's objects add to each octant
//   assign_owners  finds the ranks that each object is sent to, and the number of objects for each rank
//   pack           copies boxes, paddings, and positions or indices to arrays: ordered by receiving rank, then by position
//
// Invariants 1. The objects received from all ranks, in rank order, are ascending by position, set after set. So a rank numbers
//               its received objects in the order of their positions.
//            2. Each step works on blocks of objects. Threads share the blocks.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/object_arrays.hpp"
#include "engine/mpi/partition/octant_owners.hpp"
#include "octree/build/box_locator.hpp"
#include "octree/build/build_steps.hpp"
#include "octree/executor.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

class Routing {
    struct Crosser {
        std::size_t object;
        OctantOwners::Reach reach;
    };
    struct Block {
        unsigned set = 0;
        ObjectBlock objects = {};                // of the source
        std::optional<std::size_t> bad = {};     // first object of the first batch with an invalid box
        std::vector<Crosser> crossers = {};      // objects whose boxes extend beyond their home leaf; ascending
        RankCounts counts = {};                  // number of objects for each rank
        std::vector<std::uint32_t> owners = {};  // for each object marked `several_`: number of owners, then the owners
        std::uint64_t shared = 0;                // number of objects with several owners

        void begin(unsigned of_set, const ObjectBlock& block) {
            set = of_set;
            objects = block;
            bad.reset();
            crossers.clear();
            owners.clear();
            shared = 0;
        }
    };

public:
    /// Memory that is kept between calls, because the operating system must clear new pages first.
    class Memory {
        friend Routing;
        std::vector<Block> blocks_;
        Buffer<std::uint32_t> places_;
    };

    /// Borrows all arguments but the token. `source`: this rank's objects. `layout`: the octants that all ranks store.
    Routing(const JointCall& call, const BoxSource& source, const OctreeLayout& layout, Memory& memory,
            std::stop_token stop);

    /// Finds the home leaf of each object. Stores the estimated load of each octant in `loads`.
    /// Requires: `loads` has one empty load for each octant. Throws: Error{cancelled}; BadObject for an invalid box.
    void find_homes(Executor& executor, std::span<OctantLoad> loads);
    /// Finds the ranks that each object is sent to. Borrows `owners` as long as this object lives. Requires: find_homes().
    void assign_owners(Executor& executor, const OctantOwners& owners);
    /// Returns how many objects of a set go to each rank. Requires: assign_owners().
    RankCounts counts(unsigned set) const;
    /// Returns the number of objects with several owners. Requires: assign_owners().
    std::uint64_t shared_objects() const;
    /// Copies the objects of a set to `out`, ordered by receiving rank, then by position. `objects`: this rank's slice of the
    /// set. Requires: assign_owners().
    void pack(Executor& executor, unsigned set, const Objects& objects, ObjectArrays& out) const;

private:
    class SourceBatch;
    void find_homes(Block& block, std::span<OctantLoad> loads);
    void add_loads(const SourceBatch& boxes, std::size_t count, const LocatedBatch& batch,
                   std::span<OctantLoad> loads) const;
    void assign_owners(Block& block);
    void share(Block& block, std::span<const Crosser> crossers) const;
    template <typename Place>
    void for_each_copy(const Block& block, RankCounts& next, const Place& place) const;

    const JointCall& call_;
    const BoxSource& source_;
    const OctreeLayout& layout_;
    BoxLocator locator_;
    std::stop_token stop_;
    std::size_t counted_stride_ = 1;  // loads are estimated from one batch of so many, which is exact enough
    std::vector<Block>& blocks_;
    const OctantOwners* owners_ = nullptr;
    Buffer<std::uint32_t>& places_;  // home leaf of each object; after assign_owners() its owner, or `several_`
    std::uint32_t several_ = 0;      // marks objects that may have several owners
};

}  // namespace octopair
