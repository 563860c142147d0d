// Routing: prepares the objects of a rank for sending to the ranks that own their octants.
//
//   find_homes     finds the home leaf of each object, and the number of this rank's entries in each octant
//   assign_owners  finds the ranks that each object is sent to, and the number of objects for each rank
//   pack           copies boxes, paddings, and positions or indices to arrays: ordered by receiving rank, then by position.
//                  Boxes and paddings that stay on this rank are copied to the arrays of received objects.
//
// Invariants 1. The objects received from all ranks, in rank order, are ascending by position, set after set. So a rank numbers
//               its received objects in the order of their positions.
//            2. Each step works on blocks of objects. Threads share the blocks.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/memory.hpp"
#include "base/tuning.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/object_arrays.hpp"
#include "engine/mpi/partition/octant_owners.hpp"
#include "octree/build/chunk_lists.hpp"
#include "octree/build/encoder.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/executor.hpp"

namespace octopair {

class Routing {
    struct Crosser {
        std::size_t object;
        OctantOwners::Reach reach;
    };
    struct Block {
        unsigned set = 0;
        ObjectBlock objects = {};                // the block's range of objects in the source
        std::optional<std::size_t> bad = {};     // begin of the first batch that has an invalid box
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

    /// Finds the home leaf of each object. Returns the number of entries of each octant, in a unit for which the sum over all
    /// ranks has 32 bits. An object counts in its home leaf, and in the leaf of its high corner if that is another leaf.
    /// Throws: Error{cancelled}; BadObject for an invalid box.
    std::vector<std::uint32_t> find_homes(Executor& executor);
    /// Finds the ranks that each object is sent to. Borrows `owners` as long as this object lives. Requires: find_homes().
    void assign_owners(Executor& executor, const OctantOwners& owners);
    /// Returns how many objects of a set go to each rank. Requires: assign_owners().
    RankCounts counts(unsigned set) const;
    /// Returns the number of objects with several owners. Requires: assign_owners().
    std::uint64_t shared_objects() const;
    /// Returns whether each receiver gets an object of each block of the set. Then positions that follow each other in a message
    /// differ by less than two blocks, and near_position() identifies them. Requires: assign_owners().
    bool are_positions_near(unsigned set) const;
    /// Returns the lowest bits of a position: at most 16.
    static std::uint16_t near_position(std::uint32_t position) { return std::uint16_t(position & near_bits()); }
    /// Returns the position that follows `before` and has the bits `near`.
    static std::uint32_t position_after(std::uint32_t before, std::uint16_t near) {
        return before + ((near - before) & near_bits());
    }

    /// Arrays that pack() fills.
    struct Packed {
        unsigned rank;          ///< this rank
        ObjectArrays& sent;     ///< ordered by receiving rank; for objects that stay on this rank it has only the names
        ObjectArrays& own;      ///< receives the boxes and paddings of objects that stay on this rank
        std::size_t own_place;  ///< place in `own` of the first object that stays on this rank
    };
    /// Copies the objects of a set to `to`. Names are indices, near positions or positions, as `to.sent` says. `objects`: this
    /// rank's slice of the set. Requires: assign_owners(); the arrays are large enough.
    void pack(Executor& executor, unsigned set, const Objects& objects, const Packed& to) const;

private:
    static std::uint32_t near_bits() { return std::uint32_t(std::bit_ceil(2 * tuning().ranks.block) - 1); }
    bool locate(std::size_t begin, std::size_t count, LocatedBatch& batch) const;
    void find_homes(Block& block, std::span<std::uint64_t> entries);
    void assign_owners(Block& block);
    void share(Block& block, std::span<const Crosser> crossers) const;
    template <typename... Columns>
    void copy(const Block& block, Columns&&... columns) const;
    template <typename... Sources>
    void pack_columns(Executor& executor, unsigned set, unsigned rank, const Sources&... sources) const;

    const JointCall& call_;
    const BoxSource& source_;
    const OctreeLayout& layout_;
    BoxLocator locator_;
    std::stop_token stop_;
    std::vector<Block>& blocks_;
    const OctantOwners* owners_ = nullptr;
    Buffer<std::uint32_t>& places_;  // home leaf of each object; after assign_owners() its owner, or `several_`
    std::uint32_t several_ = 0;      // marks objects that may have several owners
};

}  // namespace octopair
