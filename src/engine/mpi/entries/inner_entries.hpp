// InnerEntries: sends the entries of inner octants, which are too large for smaller octants, to all ranks that need them: the rank that
// owns the octant, and those that own a descendant that the box touches.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/octant_owners.hpp"
#include "octree/build/linear_octree.hpp"

namespace octopair {

/// An entry of an inner octant, as it is sent.
struct InnerEntry {
    OctantIndex octant;
    std::array<std::uint32_t, 3> ends;  ///< as in CellEntry
    std::uint32_t object;
};

class InnerEntries {
public:
    explicit InnerEntries(Communicator& comm) : comm_(comm) {}

    /// Collective. Exchanges the entries of inner octants. `octree`, `own`: the entries and the boxes of this rank's objects.
    /// Throws: as Agreement::together.
    void exchange(const JointCall& call, const LinearOctree& octree, const BoxSource& own, const OctantOwners& owners);

    /// Returns the received entries of an octant, in the order of the local engine. They are valid as long as this object.
    std::span<const CellEntry> of(OctantIndex octant) const;
    /// Returns all received entries.
    std::span<const CellEntry> all() const { return entries_; }

private:
    void sort(std::vector<InnerEntry> received);

    Communicator& comm_;
    std::vector<OctantIndex> octants_;  // octant of each received entry, ascending
    std::vector<CellEntry> entries_;
};

}  // namespace octopair
