// The steps of RankSearch that distribute the octree: from this rank's slice of the objects to its share of the search.
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/test_hooks.hpp"
#include "engine/mpi/partition/octant_owners.hpp"
#include "engine/mpi/partition/octree_planning.hpp"
#include "engine/mpi/partition/routing.hpp"
#include "engine/mpi/rank_search.hpp"
#include "engine/threads/team_output.hpp"
#include "octopair/error.hpp"

namespace octopair {

RankShare RankSearch::plan_alone(RankCall& rank_call, const BoxSource& own) {
    const CostMeter meter(comm_, costs_.plan);
    RankShare share{make_layout(own, rank_call.stop.get_token())};
    share.end = OctantIndex(share.layout.directory.octants().size());
    costs_.octants = share.end;
    return share;
}

RankShare RankSearch::plan_and_route(RankCall& rank_call, const BoxSource& own) {
    std::optional<OctreePlanning> planning;
    {
        const CostMeter meter(comm_, costs_.plan);
        planning.emplace(comm_, rank_call.joint, own, rank_call.stop.get_token());
    }
    const OctantOwners owners = route(rank_call, own, *planning);
    return grow(rank_call, *planning, owners);
}

/// Sends each object to the ranks whose octants it touches, and receives the objects for this rank. Returns the owners of the octants of
/// the shared top.
OctantOwners RankSearch::route(RankCall& rank_call, const BoxSource& own, const OctreePlanning& planning) {
    const OctreeLayout& shared = planning.shared();
    TeamExecutor threads(passes_.threads());
    RankExecutor executor(threads, rank_call.stops);
    std::vector<std::uint32_t> entries;  // number of entries of each octant
    std::optional<Routing> routing;
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.route);
        routing.emplace(rank_call.joint, own, shared, routing_, rank_call.stop.get_token());
        entries = routing->find_homes(executor);
    });
    comm_.add_up(std::span(entries));
    std::optional<OctantOwners> owners;
    rank_call.agreement.together([&] {
        const CostMeter meter(comm_, costs_.route);
        owners.emplace(planning.top(), shared.directory, entries, comm_.size());
        routing->assign_owners(executor, *owners);
    });
    costs_.shared_objects = routing->shared_objects();
    exchange_objects(rank_call, executor, *routing);
    return std::move(*owners);
}

/// Divides the octants that this rank owns. Returns this rank's share.
RankShare RankSearch::grow(RankCall& rank_call, OctreePlanning& planning, const OctantOwners& owners) {
    const CostMeter meter(comm_, costs_.plan);
    OctreePlanning::OwnLayout own = planning.grow(owners);
    if (planted(Fault::rank_takes_neighbour) && own.end < own.layout.directory.octants().size()) ++own.end;
    costs_.octants = own.layout.directory.octants().size();
    RankShare share{std::move(own.layout), own.begin, own.end};
    if (rank_call.joint.indexed) return share;
    ObjectPositions& positions = share.positions.emplace();
    for (unsigned set = 0; set < rank_call.sets(); ++set) {
        positions.of_set[set] = std::as_const(exchanged_[set].received.positions).span();
    }
    if (rank_call.joint.join) positions.second_begin = std::uint32_t(rank_call.joint.totals[0]);
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
