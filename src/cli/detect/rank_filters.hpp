// RankFilters: filters on MPI ranks. Each rank has all objects, and filters its own piece of the pairs.
#pragma once

#include <memory>
#include <stop_token>

#include "cli/detect/filter_chain.hpp"
#include "cli/output/collision_piece.hpp"
#include "cli/ranks/cluster.hpp"

namespace octopair::cli {

/// All functions are collective. An exception is thrown on all ranks.
class RankFilters {
public:
    /// Borrows all parameters. Requires: `sets` hold all objects, not slices.
    RankFilters(const DetectRequest& request, Cluster& cluster, const SetPair& sets, const std::stop_token& stop);

    /// Filters `pairs`, the piece of this rank, and appends the result to `kept` unless that is null. The limit of `options`
    /// applies to all ranks together. Returns the sums over all ranks, without the search. The seconds are those of this rank.
    PipelineSummary run(const PairList& pairs, const Options& options, CollisionPiece* kept);

private:
    /// Replaces `summary` by the sums over all ranks. Returns how many collisions this rank keeps under the limit.
    std::uint64_t join(PipelineSummary& summary, const Options& options);
    void add_classes(PipelineSummary& summary);

    Cluster& cluster_;
    std::unique_ptr<FilterChain> filters_;
};

}  // namespace octopair::cli
