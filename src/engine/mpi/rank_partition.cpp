// The steps of RankSearch that distribute the octree: from this rank's slice of the objects to its share of the search.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/mpi/entries/box_forecast.hpp"
#include "engine/mpi/entries/object_fetch.hpp"
#include "engine/mpi/partition/octant_owners.hpp"
#include "engine/mpi/partition/octree_planning.hpp"
#include "engine/mpi/partition/regional_owners.hpp"
#include "engine/mpi/partition/routing.hpp"
#include "engine/mpi/rank_search.hpp"
#include "engine/threads/team_output.hpp"
#include "octopair/error.hpp"

namespace octopair {

RankShare RankSearch::plan_alone(RankCall& rank_call, const BoxSource& own) {
    const CostMeter meter(comm_, costs_.plan);
    RankShare share{make_layout(own, rank_call.stop.get_token())};
    share.end = OctantIndex(share.layout->directory.octants().size());
    costs_.octants = share.end;
    return share;
}

void RankSearch::plan(RankCall& rank_call, const BoxSource& own, std::optional<OctreePlanning>& planning) {
    const CostMeter meter(comm_, costs_.plan);
    planning.emplace(comm_, rank_call.joint, own, rank_call.stop.get_token());
}

/// Entries are sent if pairs in doubt can wait until the scan has ended, unless many boxes will probably be needed: as the plan says, or
/// because an earlier call of this engine needed them.
bool RankSearch::can_send_entries(const RankCall& rank_call, const OctreePlanning& planning) {
    const bool kept = rank_call.indexed == nullptr && output_kind_of(rank_call.output) != OutputKind::sink;
    const bool whole_list = rank_call.output.list == nullptr || !rank_call.request.options.limit;
    const bool failed = calls_with_boxes_ > 0;
    if (failed) --calls_with_boxes_;
    return kept && whole_list && planning.whole() && !planning.needs_coordinates() && !failed;
}

/// Encodes this rank's objects, and exchanges the entries. Returns this rank's share.
/// Throws: NeedsBoxes.
RankShare RankSearch::exchange_entries(RankCall& rank_call, const BoxSource& own, OctreePlanning& planning) {
    LinearOctree& octree = passes_.octree();
    TeamExecutor threads(passes_.threads());
    RankExecutor executor(threads, rank_call.stops);
    encode(rank_call, own, planning.take_shared(), executor);
    EntryExchange exchange(comm_, rank_call.joint, octree, entries_);
    std::vector<std::uint32_t> own_entries, entries;  // number of entries of each octant, of this rank and of all ranks
    rank_call.agreement.together([&] { entries = own_entries = exchange.entries(); });
    comm_.add_up(std::span(entries));
    const bool inner = check_entries(octree, entries);
    const OctantOwners owners = owners_of_entries(rank_call, planning, own_entries, entries);
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.pack);
        exchange.pack(executor, owners);
    });
    exchange.exchange();
    InnerEntries& received = rank_call.inner.emplace(comm_);
    if (inner) {
        const CostMeter meter(comm_, costs_.pack);
        received.exchange(rank_call.joint, octree, own, owners);
    }
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.pack);
        exchange.arrange(received);
    });
    count_path(Path::ranks_entries_sent);
    RankShare share;
    if (owners.in_runs()) {
        share.begin = owners.begin(comm_.rank());
        share.end = owners.end(comm_.rank());
    } else {
        share.end = OctantIndex(octree.octants().size());  // the octants of other ranks have no entries here
    }
    fetch_boxes(rank_call, {octree, share.begin, share.end});
    share.source = &*rank_call.known;
    costs_.octants = octree.octants().size();
    costs_.objects_received = octree.entry_count(share.begin, share.end);
    return share;
}

/// Makes the entries of this rank's objects.
void RankSearch::encode(RankCall& rank_call, const BoxSource& own, OctreeLayout layout, RankExecutor& executor) {
    // A block of objects has two lists for each octant. So few blocks have lists of many entries, whatever the number of threads.
    constexpr std::size_t objects_per_octant = 16;
    const std::size_t octants = layout.directory.octants().size();
    executor.limit_width(
        unsigned(std::min<std::size_t>(executor.width(), own.size() / (objects_per_octant * octants) + 1)));
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.build);
        const PositionedObjects objects(own, rank_call.joint);
        try {
            passes_.octree().build(std::move(layout), objects, executor, rank_call.stop.get_token());
        } catch (const LinearOctree::Invalid& invalid) {
            rank_call.joint.refuse(own, invalid.begin);
        }
    });
}

/// Fetches the boxes that a scan of this rank's octants will probably need.
void RankSearch::fetch_boxes(RankCall& rank_call, const OctreeRange& octants) {
    WantedObjects wanted;
    const CostMeter meter(comm_, costs_.pack);
    rank_call.agreement.together([&] { wanted = forecast_boxes(rank_call.joint, octants, *rank_call.inner); });
    if (comm_.sum(wanted[0].size() + wanted[1].size()) > 0) {
        for (unsigned set = 0; set < rank_call.sets(); ++set)
            rank_call.fetched[set] = fetch_objects(comm_, {rank_call.joint, set, rank_call.slices[set]}, wanted[set]);
    }
    const std::uint64_t most_postponed = octants.octree.entry_count(octants.begin, octants.end);
    rank_call.agreement.together([&] { rank_call.known.emplace(rank_call.joint, rank_call.fetched, most_postponed); });
}

/// Collective. Returns the owners of octants. `own`, `entries`: number of entries of each octant, of this rank and of all ranks.
// NOLINTNEXTLINE(readability-function-size): call, plan, and the two numbers of each octant.
OctantOwners RankSearch::owners_of_entries(RankCall& rank_call, const OctreePlanning& planning,
                                           std::span<const std::uint32_t> own, std::span<const std::uint32_t> entries) {
    std::vector<std::uint64_t> work;
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.pack);
        work = planning.work(entries);
    });
    // Octal pairs are in the order of octants, so each rank must own one run. An entry that is handed down crosses runs.
    const bool any_order = rank_call.output.list == nullptr || rank_call.request.options.order == Order::ascending;
    const auto is_empty_or_leaf = [&](OctantIndex octant) {
        return entries[octant] == 0 || passes_.octree().octants()[octant].leaf();
    };
    bool only_leaves = true;
    for (OctantIndex octant = 0; octant < entries.size(); ++octant) only_leaves &= is_empty_or_leaf(octant);
    std::optional<OctantOwners> regional;
    if (any_order && only_leaves) {
        const CostMeter meter(comm_, costs_.pack);
        regional = regional_owners(comm_, {own, entries, work});
    }
    if (regional) return *std::move(regional);
    OctantOwners owners;
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.pack);
        owners = {work, comm_.size()};
    });
    return owners;
}

/// Returns whether inner octants have entries. `entries`: number of entries of each octant, of all ranks.
/// Throws: NeedsBoxes, on all ranks.
bool RankSearch::check_entries(const LinearOctree& octree, std::span<const std::uint32_t> entries) {
    std::uint64_t inner = 0, all = 0, largest = 0;
    for (OctantIndex octant = 0; octant < entries.size(); ++octant) {
        const std::uint64_t own = entries[octant];
        all += own;
        inner += octree.octants()[octant].leaf() ? 0 : own;
        largest = std::max(largest, own);
    }
    // The boxes of entries in inner octants are fetched, so many of them would take more bytes than the boxes of all objects.
    const bool many = double(inner) > tuning().ranks.max_inner_part * double(all);
    if (largest > tuning().scan.max_swept_list || many) throw NeedsBoxes{};
    return inner > 0;
}

/// Exchanges this rank's objects. Returns this rank's share.
RankShare RankSearch::exchange_boxes(RankCall& rank_call, const BoxSource& own, OctreePlanning& planning) {
    count_path(Path::ranks_boxes_sent);
    TeamExecutor threads(passes_.threads());
    RankExecutor executor(threads, rank_call.stops);
    std::vector<std::uint32_t> entries;  // number of entries of each octant
    std::optional<Routing> routing;
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.route);
        routing.emplace(rank_call.joint, own, planning.shared(), routing_, rank_call.stop.get_token());
        entries = routing->find_homes(executor);
    });
    if (planning.whole()) comm_.add_up(std::span(entries));
    OctantOwners owners;
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.route);
        owners = planning.owners(entries);
        routing->assign_owners(executor, owners);
    });
    costs_.shared_objects = routing->shared_objects();
    exchange_objects(rank_call, executor, *routing);

    const CostMeter meter(comm_, costs_.plan);
    OctreePlanning::OwnLayout layout = planning.take_own(owners);
    if (planted(Fault::rank_takes_neighbour) && layout.end < layout.layout.directory.octants().size()) ++layout.end;
    costs_.octants = layout.layout.directory.octants().size();
    RankShare share{std::move(layout.layout), layout.begin, layout.end};
    if (rank_call.joint.indexed) return share;
    for (unsigned set = 0; set < rank_call.sets(); ++set)
        share.positions[set] = std::as_const(exchanged_[set].received.positions).span();
    return share;
}

/// Sends the objects of each set to their owners, and receives the objects that this rank owns.
void RankSearch::exchange_objects(RankCall& rank_call, Executor& executor, const Routing& routing) {
    const CostMeter meter(comm_, costs_.pack);
    std::uint64_t incoming = 0;
    for (unsigned set = 0; set < rank_call.sets(); ++set) {
        const ObjectExchange objects(comm_, rank_call.joint, routing, set);
        incoming += objects.incoming();
        rank_call.agreement.together([&] {
            if (incoming > max_objects)
                throw Error(ErrorCode::resource_limit, "more than 2^32 - 1 objects on one rank");
            objects.pack(executor, rank_call.slices[set], exchanged_[set]);
        });
        objects.exchange(exchanged_[set]);
        costs_.objects_received += objects.incoming();
    }
}

}  // namespace octopair
