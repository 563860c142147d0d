// SliceDistribution: rank 0, which has all objects of a call, sends each rank its slice. Assignment announces the call.
//
// Slices are contiguous, about equally long, and in rank order. They are sent in rounds of some megabytes; each round first
// checks for a stop request.
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/request.hpp"

namespace octopair {

/// Message of rank 0 to the other ranks: parameters of the next call, or `end`: no call follows. Broadcast as bytes.
struct Assignment {
    struct Set {
        std::uint64_t objects = 0;
        bool wide = false, padded = false;
    };
    bool end = true;
    bool join = false, limited = false;
    OutputKind output_kind = OutputKind::count;
    Order order = Order::ascending;
    double margin = 0;
    std::uint64_t limit = 0, buffer_bytes = 0;
    std::array<Set, 2> sets = {};

    static Assignment of(const detail::Request& request, OutputKind output_kind);
    /// Returns the options of the call, without a progress function.
    Options options() const;
};

/// A rank's slice of each set of a call. Rank 0 uses its part of the call's objects in place. Memory is kept for later calls.
class SliceDistribution {
public:
    explicit SliceDistribution(Communicator& comm) : comm_(comm) {}

    /// Collective. Distributes the objects of `request`, which is null on all ranks but rank 0. Borrows the objects until the
    /// next call. Throws: as Agreement::together, for a rank that is out of memory; Error{cancelled} after a stop request.
    void make(const Assignment& assignment, const detail::Request* request, const std::stop_token& stop);
    const Objects& slice(unsigned set) const { return slices_[set]; }

private:
    struct Memory {
        Buffer<Box3f> boxes;
        Buffer<Box3d> wide_boxes;
        Buffer<double> padding;
    };
    template <typename Item>
    void distribute(std::span<const Item> all, std::uint64_t size, std::span<Item> own);
    template <typename Real>
    void distribute_set(unsigned set, const Objects* all, Buffer<Box<Real>>& boxes);
    /// Returns the begin of a rank's slice of `size` objects. Returns `size` for the number of ranks.
    std::uint64_t begin(std::uint64_t size, unsigned rank) const { return size * rank / comm_.size(); }

    Communicator& comm_;
    std::stop_token stop_;
    const Assignment* assignment_ = nullptr;
    std::array<Memory, 2> memory_;
    std::array<Objects, 2> slices_;
};

}  // namespace octopair
