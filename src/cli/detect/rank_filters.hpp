// Filters on ranks: each has all that they need to know, and filters its own piece of the pairs.
#pragma once

#include <memory>
#include <stop_token>

#include "cli/detect/filter_row.hpp"
#include "cli/output/collision_piece.hpp"
#include "cli/ranks/cluster.hpp"

namespace octopair::cli {

/// All functions are collective and throw on all ranks alike.
class RankFilters {
public:
    /// `sets`: whole. Borrows all.
    RankFilters(const DetectRequest& request, Cluster& cluster, const SetPair& sets, const std::stop_token& stop);

    /// Of `pairs`, the piece of this rank, what comes out goes to `kept`, if there is one. The limit is that of all ranks
    /// together. Returns what all ranks did, but for the search and with the seconds of this one.
    PipelineSummary run(const PairList& pairs, const Options& options, CollisionPiece* kept);

private:
    /// The sums over all ranks; how many collisions of this one stay within the limit.
    std::uint64_t join(PipelineSummary& summary, const Options& options);

    Cluster& cluster_;
    std::unique_ptr<FilterRow> row_;
};

}  // namespace octopair::cli
