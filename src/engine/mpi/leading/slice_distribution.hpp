// Dealing: rank 0, which has all objects of a call, tells the others what is asked, and gives each rank its slice.
//
// Slices are contiguous and about equally long, in the order of the ranks. They go in rounds of some megabytes, between which
// a stop is seen.
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/request.hpp"

namespace octopair {

/// What rank 0 tells the others: the next call, or that none will follow. As it is sent.
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
    /// Without a progress.
    Options options() const;
};

/// A rank's slice of each set of a call; that of rank 0 lies where the call's objects do. Its memory is kept for the next.
class SliceDistribution {
public:
    explicit SliceDistribution(Communicator& comm) : comm_(comm) {}

    /// Collective. On rank 0 with the call's objects, which are borrowed until the next one. Throws as
    /// Agreement::together: where there is no memory on a rank, Error{cancelled} on a stop.
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
    /// Where the slice of a rank begins among so many; of the rank after the last, their end.
    std::uint64_t begin(std::uint64_t size, unsigned rank) const { return size * rank / comm_.size(); }

    Communicator& comm_;
    std::stop_token stop_;
    const Assignment* assignment_ = nullptr;
    std::array<Memory, 2> memory_;
    std::array<Objects, 2> slices_;
};

}  // namespace octopair
