// RankSearch: what a rank does in a call, from its slice of the objects to its piece of the pairs.
//
//   join    what all ranks ask for                                                           (joint_call.hpp)
//   plan    the octree's octants, from the sample that the local engine would take            (planting.hpp)
//   cut     the pre-order of octants into runs of about equal work, one for each rank         (octant_owners.hpp)
//   route   objects to the ranks whose octants they touch                                     (routing.hpp)
//   search  each rank the octants it owns, as the local engine would                          (rank_passes.hpp)
//   order   ascending: pairs to the ranks that their `a` belongs to, where they are sorted    (ascending_pieces.hpp)
//
// The pieces of all ranks, one after another, are what the local engine finds. What every rank gets to know is the shape of
// the tree, and a few numbers for each rank and octant; nothing else is gathered, unless rank 0 is to receive all pairs.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/paper/master_search.hpp"
#include "engine/mpi/partition/object_arrays.hpp"
#include "engine/mpi/partition/routing.hpp"
#include "engine/mpi/rank_passes.hpp"
#include "engine/pair_list.hpp"
#include "engine/request.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

class PiecePlan;
class Receiver;

/// Who receives pairs: each rank its piece, or the first rank those of all, in order.
enum class Recipients : std::uint8_t { all, first };

/// A call for pairs of indices that are the caller's own, or of more bits than a Pair has.
struct IndexedCall {
    std::array<std::span<const std::uint64_t>, 2> indices;  ///< of each set; empty: 0, 1, ... from rank to rank
    std::vector<Pair64>& pairs;
};

class RankSearch {
public:
    /// `beside`, which may be empty, is done every few milliseconds of a call, on its thread; what it throws ends the call on
    /// this rank.
    RankSearch(Communicator& comm, const MpiOptions& options, std::function<void()> beside = {});

    /// Collective. The summary is that of all ranks, but for the steps, which are this rank's. Of the recipients that a list
    /// or a sink is given on all ranks for, the first rank alone may get pairs.
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control,
                Recipients recipients = Recipients::all);
    /// The same of an indexed call, whose `pairs` are the output of all ranks.
    Summary run(const detail::Request& request, const IndexedCall& indexed, const detail::Control& control);
    /// In place of run() on a rank whose call was cancelled before it began: ends it on all. Does not throw.
    void skip() noexcept;
    /// Collective: this rank's piece goes to rank 0, which appends those of all ranks to `all`.
    void gather(PairList& piece, detail::PairStorage& all);
    /// Of the last run().
    const RankCosts& costs() const { return costs_; }

private:
    struct Task;
    /// Hands this rank's pairs to a receiver.
    using Give = std::function<void(Receiver&)>;
    struct OctalPairs;
    Summary run(Task& task, const detail::Control& control);
    void find(Task& task);
    void join(Task& task);
    void find_at_master(Task& task);
    OctreeLayout plan(Task& task, const BoxSource& own);
    RankShare route(Task& task, const BoxSource& own, OctreeLayout layout);
    void exchange_objects(Task& task, const Routing& routing);
    void search(Task& task, const detail::Request& own_octants);
    void build(Task& task, Call& call);
    void count(Task& task, Call& call);
    void find_octal(Task& task, Call& call);
    void find_ascending(Task& task, Call& call);
    bool list_octal(Call& call, std::uint64_t most);
    void find_windows(Task& task, Call& call);
    void find_indexed(Task& task, Call& call);
    std::uint64_t relay_octal(Task& task, Call& call, const OctalPairs& own);
    std::uint64_t allowed(Task& task, const PiecePlan& plan) const;
    void deliver(Task& task, std::uint64_t allowance, const Give& give);

    Communicator& comm_;
    std::function<void()> beside_;
    RankPasses passes_;
    std::array<ObjectArrays, 2> sent_, received_;
    Routing::Memory routing_;
    PairList found_;
    RankCosts costs_;
    std::optional<MasterSearch> master_;  // of the paper's arrangement
};

}  // namespace octopair
