// Calls with 64-bit indices: sorts the objects over all ranks by the indices that the caller gave them (IndexOrder), and afterwards the
// pairs of these indices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/object_arrays.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

class IndexOrder {
public:
    explicit IndexOrder(Communicator& comm) : comm_(comm) {}

    /// Collective. Sorts a set of the call. Each rank passes its slice of the set, with an index for each object. If all ranks
    /// pass no indices, objects keep their order and their positions are the indices. Borrows the objects.
    /// Throws: Error{bad_input} if two objects have the same index, or a rank has fewer or more indices than objects;
    /// Error{usage} if only some ranks pass indices.
    void take(const JointCall& call, unsigned set, const Objects& own, std::span<const std::uint64_t> indices);

    /// Returns this rank's part of a sorted set.
    const Objects& objects(unsigned set) const { return objects_[set]; }
    /// Returns the indices of these objects, ascending.
    std::span<const std::uint64_t> indices(unsigned set) const { return arrays_[set].indices.span(); }

private:
    bool are_given(const Objects& own, std::span<const std::uint64_t> indices);
    void exchange_and_sort(ObjectArrays& arrays, const Objects& own, std::span<const std::uint64_t> indices);

    Communicator& comm_;
    std::array<ObjectArrays, 2> arrays_;
    std::array<Objects, 2> objects_;
};

/// Appends the pairs of `found` to `pairs`, with `a` and `b` replaced by their indices. Requires: `pairs` is empty.
void name_pairs(const PairList& found, std::span<const std::uint64_t> a_indices,
                std::span<const std::uint64_t> b_indices, std::vector<Pair64>& pairs);

/// Collective. Replaces this rank's pairs by its piece of the ascending sequence of the pairs of all ranks.
/// Throws: as Agreement::together.
void sort_over_ranks(Communicator& comm, std::vector<Pair64>& pairs);

}  // namespace octopair
