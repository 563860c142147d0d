// Routing: objects on their way to the ranks that own their octants.
//
//   find     each object's home leaf -> how much work each octant makes with this rank's objects
//   address  with the owners: the ranks that each object goes to, and how many objects go to each rank
//   pack     boxes, paddings, positions or indices, one rank's after another's, each rank's ascending by position
// What arrives from all ranks, in their order, is then again ascending by position, set after set; so within a rank objects
// have numbers of their own, in the same order as their positions.
//
// Each step goes over blocks of objects, which threads share.
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
        std::optional<std::size_t> bad = {};     // the first that is not a box
        std::vector<Crosser> crossers = {};      // out of the leaf that they begin in; ascending
        RankCounts counts = {};                  // of each rank
        std::vector<std::uint32_t> owners = {};  // of those that may have several: how many, and these
        std::uint64_t shared = 0;

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
    /// What is kept from call to call: pages that are new have to be cleared first.
    class Memory {
        friend Routing;
        std::vector<Block> blocks_;
        Buffer<std::uint32_t> places_;
    };

    /// Borrows all. `source`: this rank's objects.
    Routing(const JointCall& call, const BoxSource& source, const OctreeLayout& layout, Memory& memory,
            std::stop_token stop);

    /// Adds to `loads`, empty ones, one for each octant. Throws Error{cancelled}; BadObject for a box that is not one.
    void find(Executor& executor, std::span<OctantLoad> loads);
    /// Borrows `owners` until the end.
    void address(Executor& executor, const OctantOwners& owners);
    /// After address(): how many of a set go to each rank, and how many of all have several owners.
    RankCounts counts(unsigned set) const;
    std::uint64_t shared_objects() const;
    /// Those of a set.
    void pack(Executor& executor, unsigned set, const Objects& objects, ObjectArrays& out) const;

private:
    void find(Block& block, std::span<OctantLoad> loads);
    void address(Block& block);
    void share(Block& block, std::span<const Crosser> crossers) const;
    template <typename Place>
    void for_each_copy(const Block& block, RankCounts& next, const Place& place) const;

    const JointCall& call_;
    const BoxSource& source_;
    const OctreeLayout& layout_;
    std::stop_token stop_;
    std::size_t counted_stride_ = 1;  // of batches: what octants hold is known from a part well enough
    std::vector<Block>& blocks_;
    const OctantOwners* owners_ = nullptr;
    Buffer<std::uint32_t>& places_;  // of each object: the leaf that it begins in; after address() its owner
    std::uint32_t several_ = 0;      // in place of an owner
};

}  // namespace octopair
