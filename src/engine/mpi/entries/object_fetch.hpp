// The ranks fetch the boxes and paddings of some objects from each other.
#pragma once

#include <cstdint>
#include <span>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/object_arrays.hpp"

namespace octopair {

/// A set of a call, and this rank's slice of the set. Borrows both.
struct SetSlice {
    const JointCall& call;
    unsigned set;
    const Objects& objects;
};

/// Collective. Returns the objects at the given positions of the set, which ascend. Each rank sends the objects of its slice that other
/// ranks ask for.
/// Throws: as Agreement::together.
ObjectArrays fetch_objects(Communicator& comm, const SetSlice& slice, std::span<const std::uint32_t> positions);

}  // namespace octopair
