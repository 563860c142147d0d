// EntryExchange: sends the entries that each rank has encoded to the ranks that own their octants. The received entries become the
// octree of each rank.
//
//   encode    each rank builds an octree of its own objects, with the octants of the whole octree
//   pack      copies the entries of leaves to an array, ordered by receiving rank
//   exchange  sends these entries; those of inner octants are sent separately                        (inner_entries.hpp)
//   arrange   orders the received entries by octant, as the local engine does
//
// Invariants 1. An entry is the one that the local engine makes, bit for bit. Its object is a position among the objects of all ranks.
//            2. Entries are not copied when they are arranged: an octant has a run of entries for each sending rank. Entries that stay on
//               this rank are not even packed, except in a join.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/entries/inner_entries.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/octant_owners.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/executor.hpp"

namespace octopair {

/// This rank's objects, numbered by their positions among the objects of all ranks.
class PositionedObjects final : public ForwardingSource {
public:
    /// Borrows both.
    PositionedObjects(const BoxSource& own, const JointCall& call) : ForwardingSource(own), call_(call) {}

    bool load(std::size_t begin, std::span<Entry> out) const override {
        const bool good = source().load(begin, out);
        for (Entry& entry : out) entry.object = std::uint32_t(call_.position(entry.object));
        return good;
    }
    Float32Boxes float32_boxes(std::size_t begin, std::span<Box3f> room) const override {
        Float32Boxes boxes = source().float32_boxes(begin, room);
        boxes.first_object += std::uint32_t(call_.begins[0]);  // only without a second set
        return boxes;
    }

private:
    const JointCall& call_;
};

class EntryExchange {
public:
    /// Arrays that are kept between calls, because the operating system must clear new pages first.
    struct Memory {
        Buffer<CellEntry> sent, received;
    };

    /// Borrows all arguments. `octree`: of this rank's objects (PositionedObjects).
    EntryExchange(Communicator& comm, const JointCall& call, LinearOctree& octree, Memory& memory);

    /// Returns the number of this rank's entries in each octant.
    std::vector<std::uint32_t> entries() const;
    /// Copies the entries of leaves that other ranks own.
    void pack(Executor& executor, const OctantOwners& owners);
    /// Collective. Sends the entries of leaves.
    void exchange();
    /// Replaces the entries of the octree by those of the octants that this rank owns. `inner`: the received entries of inner octants.
    void arrange(const InnerEntries& inner);

private:
    /// Number of entries of one set in one list of an octant, on one rank. 16 bits are enough: the caller sends no entries if an octant has
    /// more than tuning().scan.max_swept_list.
    using Count = std::uint16_t;
    static constexpr unsigned lists = 2;

    bool is_packed(unsigned rank) const { return rank != comm_.rank() || call_.join; }
    void pack(unsigned rank, CellEntry* out);
    template <typename Visit>
    void for_each_run(OctantIndex octant, OctantList list, unsigned set, Visit&& visit) const;

    Communicator& comm_;
    const JointCall& call_;
    LinearOctree& octree_;
    Memory& memory_;
    unsigned sets_;
    const OctantOwners* owners_ = nullptr;
    // Numbers of packed entries: rank after rank, then by set, octant of the receiving rank, and list.
    std::vector<Count> sent_counts_, received_counts_;
    std::vector<std::size_t> count_begins_;  // of each receiving rank in sent_counts_
    RankCounts sent_;                        // number of packed entries for each rank
};

}  // namespace octopair
