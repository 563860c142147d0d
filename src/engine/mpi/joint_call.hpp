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

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/request.hpp"

namespace octopair {

/// What becomes of the pairs; the same on all ranks.
enum class OutputKind : std::uint8_t { count, list, sink };

inline OutputKind output_kind_of(const detail::Output& output) {
    if (output.list != nullptr) return OutputKind::list;
    return output.sink != nullptr ? OutputKind::sink : OutputKind::count;
}

struct JointCall {
    bool join = false;
    std::array<std::uint64_t, 2> totals = {0, 0};  ///< objects of each set
    std::array<std::uint64_t, 2> begins = {0, 0};  ///< where this rank's begin in it,
    std::array<std::uint64_t, 2> sizes = {0, 0};   ///< and how many it brought
    std::array<bool, 2> wide = {}, padded = {};    ///< whether boxes are float64, objects have paddings
    EntryForm form;
    /// Of this rank's objects, where they have indices of their own, of 64 bits; borrowed.
    std::array<std::span<const std::uint64_t>, 2> indices = {};
    bool indexed = false;

    /// A set of this rank's as it is held on all: of none, the caller may have said another precision.
    Objects slice(unsigned set, const Objects& given) const {
        if (given.size() > 0) return given;
        return wide[set] ? Objects{std::span<const Box3d>(), {}} : Objects{std::span<const Box3f>(), {}};
    }
    std::uint64_t objects() const { return totals[0] + totals[1]; }
    /// Above every `b` of a pair.
    std::uint64_t columns() const { return totals[join ? 1 : 0]; }
    /// Of an object of this rank's source.
    std::uint64_t position(std::uint64_t own) const {
        return own < sizes[0] ? begins[0] + own : totals[0] + begins[1] + (own - sizes[0]);
    }
    /// Throws BadObject for the first object of this rank's source, from this one on, that is not a box.
    [[noreturn]] void refuse(const BoxSource& source, std::size_t own) const;

private:
    /// What to add to its number in this rank's slice for what it is called.
    SetBegins named_from(std::uint64_t own) const {
        if (!indexed) return {begins[0], begins[1]};
        if (own < sizes[0]) return {indices[0][std::size_t(own)] - own, 0};
        own -= sizes[0];
        return {0, indices[1][std::size_t(own)] - own};
    }
};

/// Collective. Throws Error, on all ranks the same: what is wrong with any rank's options and sizes, and where ranks do not
/// ask for the same. `most_objects`: on all ranks.
JointCall join_call(Communicator& comm, const detail::Request& request, OutputKind output_kind, std::uint64_t most_objects);

/// Calls visit(i, number in this rank's source) for each sample[i] that is the position of an object of this rank. A sample
/// has a size and rising elements.
template <typename Sampled, typename Visit>
void for_each_own(const JointCall& call, const Sampled& sample, const Visit& visit) {
    for (unsigned set = 0; set < 2; ++set) {
        const std::uint64_t own_begin = set == 0 ? 0 : call.sizes[0];
        const std::uint64_t begin = (set == 0 ? 0 : call.totals[0]) + call.begins[set], end = begin + call.sizes[set];
        std::size_t least = 0, i = sample.size();
        while (least < i) {
            const std::size_t middle = least + (i - least) / 2;
            sample[middle] < begin ? least = middle + 1 : i = middle;
        }
        for (; i < sample.size() && sample[i] < end; ++i) visit(i, std::size_t(own_begin + (sample[i] - begin)));
    }
}

}  // namespace octopair
