// IndexOrder: the objects of a call in the order of indices that the caller gave them, whichever ranks they came from.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/object_arrays.hpp"

namespace octopair {

class IndexOrder {
public:
    explicit IndexOrder(Communicator& comm) : comm_(comm) {}

    /// Collective. A set of the call: each rank gives some of its objects, and their indices or, all ranks, none. Borrows the
    /// objects. Throws Error{bad_input} for an index that is there twice or not for each object.
    void take(const JointCall& call, unsigned set, const Objects& own, std::span<const std::uint64_t> indices);

    /// Of a set: this rank's part of the sequence, ascending, and what the objects in it are called.
    const Objects& objects(unsigned set) const { return objects_[set]; }
    std::span<const std::uint64_t> indices(unsigned set) const { return arrays_[set].indices.span(); }

private:
    bool are_given(const Objects& own, std::span<const std::uint64_t> indices);
    void bring_together(ObjectArrays& arrays, const Objects& own, std::span<const std::uint64_t> indices);

    Communicator& comm_;
    std::array<ObjectArrays, 2> arrays_;
    std::array<Objects, 2> objects_;
};

}  // namespace octopair
