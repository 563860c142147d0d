// JointCall: parameters of a call that all ranks agree on: sizes of the sets, slice of this rank, rounding of boxes.
//
// Invariants 1. A set is the concatenation of the slices of all ranks, in rank order.
//            2. The position of an object is its number in its set. Positions of the second set follow those of the first.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "boxes/box_source.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/request.hpp"

namespace octopair {

/// How a call returns its pairs: as their number, in a list, to a sink, or with 64-bit indices. The same on all ranks.
enum class OutputKind : std::uint8_t { count, list, sink, indexed };

inline OutputKind output_kind_of(const detail::Output& output) {
    if (output.list != nullptr) return OutputKind::list;
    return output.sink != nullptr ? OutputKind::sink : OutputKind::count;
}

struct JointCall {
    bool join = false;
    std::array<std::uint64_t, 2> totals = {0, 0};  ///< number of objects of each set, on all ranks
    std::array<std::uint64_t, 2> begins = {0, 0};  ///< begin of this rank's slice in each set
    /// Begin of each rank's slice in each set, and behind them the total.
    std::array<std::vector<std::uint64_t>, 2> starts;
    std::array<std::uint64_t, 2> sizes = {0, 0};  ///< number of objects of this rank's slice of each set
    std::array<bool, 2> wide = {}, padded = {};   ///< `wide`: boxes are float64; `padded`: objects have paddings
    EntryForm form;
    /// 64-bit indices of this rank's objects, by set; empty unless `indexed`. Borrowed.
    std::array<std::span<const std::uint64_t>, 2> indices = {};
    bool indexed = false;

    /// Returns this rank's slice of a set. An empty slice gets the precision that the other ranks use.
    Objects slice(unsigned set, const Objects& given) const {
        if (given.size() > 0) return given;
        return wide[set] ? Objects{std::span<const Box3d>(), {}} : Objects{std::span<const Box3f>(), {}};
    }
    std::uint64_t objects() const { return totals[0] + totals[1]; }
    /// Exclusive upper bound of every `b`.
    std::uint64_t columns() const { return totals[join ? 1 : 0]; }
    /// Returns the position of object `own` of this rank's source.
    std::uint64_t position(std::uint64_t own) const {
        return own < sizes[0] ? begins[0] + own : totals[0] + begins[1] + (own - sizes[0]);
    }
    /// Returns the number of an object in this rank's source. `position`: of an object in this rank's slices.
    std::uint64_t own_number(std::uint64_t position) const {
        return position < totals[0] ? position - begins[0] : sizes[0] + (position - totals[0] - begins[1]);
    }
    /// Throws: BadObject for the first object of this rank's source, from `own` on, that is not a valid box.
    [[noreturn]] void refuse(const BoxSource& source, std::size_t own) const;

private:
    /// Returns the offset, for the set of object `own`, that turns a number in this rank's slice into the object's name.
    SetBegins named_from(std::uint64_t own) const {
        if (!indexed) return {begins[0], begins[1]};
        if (own < sizes[0]) return {indices[0][std::size_t(own)] - own, 0};
        own -= sizes[0];
        return {0, indices[1][std::size_t(own)] - own};
    }
};

// The first message of a call has the same form for all kinds of calls. So ranks that make different calls detect the difference and
// throw, instead of waiting forever for messages that no rank sends.

/// Collective. Combines the searches of all ranks into one. `max_objects`: maximum number of objects of all ranks together.
/// Throws: the same Error on all ranks if the options or sizes of a rank are invalid, or if the ranks' calls differ.
JointCall join_call(Communicator& comm, const detail::Request& request, OutputKind output_kind,
                    std::uint64_t max_objects);
/// Collective. Begins gather_pairs(). Throws: the same Error on all ranks if another rank makes another call.
void join_gather(Communicator& comm);
/// Collective. Takes the place of join_call() on a rank whose call was cancelled before it began.
/// Throws always: the same Error on all ranks, in most cases Error{cancelled}.
void join_cancelled(Communicator& comm);

/// Calls visit(i, number in this rank's source) for each sample[i] that is the position of an object of this rank.
/// Requires: `sample` has size() and ascending elements.
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
