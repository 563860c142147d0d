// RankSearch: runs a call on one rank, from its slice of the objects to its piece of the pairs.
//
//   join    combines the calls of all ranks and checks that they agree                        (joint_call.hpp)
//   plan    chooses the octants of the octree, from the sample that the local engine takes    (octree_planning.hpp)
//   cut     divides the pre-order of these octants into a run of octants for each rank        (octant_owners.hpp)
//
//   then either entries are sent, which are few bytes and are encoded once,
//   encode  makes the entries of the rank's objects                                           (linear_octree.hpp)
//   send    sends each entry to the rank that owns its octant                                 (entry_exchange.hpp)
//   scan    scans the rank's octants. Pairs in doubt are kept                                 (rank_passes.hpp)
//   settle  fetches the boxes of the pairs in doubt, and drops those that are no pairs        (postponed_pairs.hpp)
//
//   or, if many boxes will be needed, or if pairs cannot wait until the scan has ended, boxes are sent:
//   route   sends each object to the ranks whose octants it touches                           (routing.hpp)
//   search  builds the rank's octree and scans the rank's octants, like the local engine      (rank_passes.hpp)
//
//   order   for ascending order: sends each pair to the rank that its `a` belongs to, which
//           sorts its pairs                                                                   (ascending_pieces.hpp)
//
// Result     the pieces of all ranks, in rank order, are the pairs that the local engine finds.
// Memory     each rank stores the whole octree if the ranks have at least three objects for each octant. Otherwise it stores the top of
//            the octree and its own octants. It also stores a few numbers for each rank and for each octant that all ranks store.
//            No data of all ranks is gathered on one rank, except the pairs with Recipients::first.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/comm/relay.hpp"
#include "engine/mpi/entries/entry_exchange.hpp"
#include "engine/mpi/entries/inner_entries.hpp"
#include "engine/mpi/entries/known_boxes.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/order/index_order.hpp"
#include "engine/mpi/partition/object_exchange.hpp"
#include "engine/mpi/partition/octree_planning.hpp"
#include "engine/mpi/partition/routing.hpp"
#include "engine/mpi/rank_passes.hpp"
#include "engine/pair_list.hpp"
#include "engine/progress.hpp"
#include "engine/request.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

class PiecePlan;
class Receiver;

/// Ranks that receive pairs. `all`: each rank receives its piece. `first`: rank 0 receives the pairs of all ranks, in order.
enum class Recipients : std::uint8_t { all, first };

/// A call whose pairs have 64-bit indices: indices of the caller, or positions that do not fit into a Pair.
struct IndexedCall {
    /// Indices of this rank's objects, by set. Empty on all ranks: 0, 1, ..., counted on from rank to rank.
    std::array<std::span<const std::uint64_t>, 2> indices;
    std::vector<Pair64>& pairs;
};

class RankSearch {
public:
    /// `on_poll` may be empty. A call runs it every few milliseconds on the calling thread; an exception of `on_poll` ends the
    /// call on this rank.
    RankSearch(Communicator& comm, const MpiOptions& options, std::function<void()> on_poll = {});

    /// Collective. Returns the summary of all ranks, except that its steps are those of this rank. With Recipients::first,
    /// every rank passes a list or a sink, but only rank 0 receives pairs.
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control,
                Recipients recipients = Recipients::all);
    /// Collective. Runs an indexed call: each rank receives its piece in `indexed.pairs`.
    Summary run(const detail::Request& request, const IndexedCall& indexed, const detail::Control& control);
    /// Replaces run() on a rank whose call was cancelled before it began. Cancels the call on all ranks.
    void skip() noexcept;
    /// Collective. Sends this rank's piece to rank 0, which appends the pieces of all ranks to `all`, in rank order.
    void gather(PairList& piece, detail::PairStorage& all);
    /// Returns the costs of the last run().
    const RankCosts& costs() const { return costs_; }

private:
    /// State of one call on this rank, which one step of the search passes to the next.
    struct RankCall {
        RankCall(RankSearch& search, const detail::Request& asked, const detail::Output& out, const ProgressSink& sink)
            : request(asked),
              output(out),
              progress_sink(sink),
              stops(search.comm_, stop, search.on_poll_),
              agreement(search.comm_),
              progress(sink),
              order(search.comm_) {}

        const detail::Request& request;
        const detail::Output& output;
        const IndexedCall* indexed = nullptr;
        Recipients recipients = Recipients::all;
        const ProgressSink& progress_sink;
        std::stop_source stop;
        StopRelay stops;
        Agreement agreement;
        Progress progress;
        std::optional<Relay> relay;  // only if a sink of rank 0 receives all pairs
        JointCall joint;
        std::array<Objects, 2> slices;
        IndexOrder order;  // used by indexed calls only
        // If entries were sent:
        std::optional<InnerEntries> inner;
        std::array<ObjectArrays, 2> fetched;  // by set
        std::optional<KnownBoxes> known;
        Summary summary;
        unsigned sets() const { return joint.join ? 2 : 1; }
    };
    static constexpr std::uint64_t max_objects =
        std::numeric_limits<std::uint32_t>::max();  // their indices fit into a Pair
    /// Passes this rank's pairs to a receiver.
    using Give = std::function<void(Receiver&)>;
    struct OctalPairs;
    Summary run(RankCall& rank_call, const detail::Control& control);
    void gather_pieces(PairList& piece, detail::PairStorage& all);
    void find(RankCall& rank_call);
    void join(RankCall& rank_call);
    /// Exception, thrown on all ranks, if boxes must be sent in place of entries.
    struct NeedsBoxes {};
    RankShare plan_alone(RankCall& rank_call, const BoxSource& own);
    void plan(RankCall& rank_call, const BoxSource& own, std::optional<OctreePlanning>& planning);
    bool can_send_entries(const RankCall& rank_call, const OctreePlanning& planning);
    RankShare exchange_entries(RankCall& rank_call, const BoxSource& own, OctreePlanning& planning);
    void encode(RankCall& rank_call, const BoxSource& own, OctreeLayout layout, RankExecutor& executor);
    void fetch_boxes(RankCall& rank_call, const OctreeRange& octants);
    OctantOwners owners_of_entries(RankCall& rank_call, const OctreePlanning& planning,
                                   std::span<const std::uint32_t> own, std::span<const std::uint32_t> entries);
    bool check_entries(const LinearOctree& octree, std::span<const std::uint32_t> entries);
    RankShare exchange_boxes(RankCall& rank_call, const BoxSource& own, OctreePlanning& planning);
    void exchange_objects(RankCall& rank_call, Executor& executor, const Routing& routing);
    bool find_by_entries(RankCall& rank_call, const BoxSource& own, OctreePlanning& planning);
    Objects received(unsigned set) const { return exchanged_[set].received.view(); }
    void search(RankCall& rank_call, const detail::Request& own_octants);
    void run_pass(RankCall& rank_call, const std::function<void()>& pass);
    std::vector<PostponedPair> settle(RankCall& rank_call);
    void drop_refused(RankCall& rank_call, detail::PairStorage& list);
    void build(RankCall& rank_call, Call& call);
    void count(RankCall& rank_call, Call& call);
    void find_octal(RankCall& rank_call, Call& call);
    void find_ascending(RankCall& rank_call, Call& call);
    bool list_octal(Call& call, std::optional<std::uint64_t> most);
    void find_windows(RankCall& rank_call, Call& call);
    void find_indexed(RankCall& rank_call, Call& call);
    std::uint64_t relay_octal(RankCall& rank_call, Call& call, const OctalPairs& own);
    std::uint64_t allowed(RankCall& rank_call, const PiecePlan& plan) const;
    void deliver(RankCall& rank_call, std::uint64_t allowance, const Give& give);

    Communicator& comm_;
    std::function<void()> on_poll_;
    RankPasses passes_;
    std::array<ObjectExchange::Memory, 2> exchanged_;
    Routing::Memory routing_;
    EntryExchange::Memory entries_;
    unsigned calls_with_boxes_ = 0;  // number of the next calls that send boxes; the same on all ranks
    PairList found_;
    RankCosts costs_;
};

}  // namespace octopair
