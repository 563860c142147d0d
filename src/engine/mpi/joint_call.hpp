// JointCall: what a call is to all ranks: how many objects there are, which of them this rank brought, how boxes become
// entries.
//
// Each rank brings a slice of each set; a set is its slices in the order of the ranks. An object's position is its number in
// its set, that of an object of the second set counted on from the first.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/mpi/communicator.hpp"
#include "engine/request.hpp"
#include "geometry/box_source.hpp"

namespace octopair {

/// What becomes of the pairs; the same on all ranks.
enum class Outlet : std::uint8_t { count, list, sink };

struct JointCall {
    bool join = false;
    std::array<std::uint64_t, 2> totals = {0, 0};  ///< objects of each set
    std::array<std::uint64_t, 2> begins = {0, 0};  ///< where this rank's begin in it,
    std::array<std::uint64_t, 2> sizes = {0, 0};   ///< and how many it brought
    std::array<bool, 2> wide = {}, padded = {};    ///< whether boxes are float64, objects have paddings
    EntryForm form;

    std::uint64_t objects() const { return totals[0] + totals[1]; }
    /// Of an object of this rank's source.
    std::uint64_t position(std::uint64_t own) const {
        return own < sizes[0] ? begins[0] + own : totals[0] + begins[1] + (own - sizes[0]);
    }
};

/// Collective. Throws Error, on all ranks the same: what is wrong with any rank's options and sizes, and where ranks do not
/// ask for the same.
JointCall join_call(Communicator& comm, const Engine::Request& request, Outlet outlet);

/// Collective: of the positions in `sample` (a size and rising elements), `value` of each, which is asked of the rank that
/// brought the object with its number there.
template <typename Value, typename Sampled, typename Ask>
std::vector<Value> gather_sample(Communicator& comm, const JointCall& call, const Sampled& sample, const Ask& value) {
    std::vector<Value> all;
    std::size_t i = 0;
    for (unsigned set = 0; set < (call.join ? 2u : 1u); ++set) {
        const std::uint64_t own_begin = set == 0 ? 0 : call.sizes[0];
        const std::uint64_t begin = (set == 0 ? 0 : call.totals[0]) + call.begins[set];
        while (i < sample.size() && sample[i] < begin) ++i;
        std::vector<Value> own;
        for (; i < sample.size() && sample[i] < begin + call.sizes[set]; ++i)
            own.push_back(value(std::size_t(own_begin + (sample[i] - begin))));
        const auto gathered = comm.all_gather(std::span<const Value>(own));
        all.insert(all.end(), gathered.values.begin(), gathered.values.end());
    }
    return all;
}

}  // namespace octopair
