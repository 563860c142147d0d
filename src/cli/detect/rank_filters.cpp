#include "cli/detect/rank_filters.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "base/timed.hpp"

namespace octopair::cli {

namespace {

/// Results of one rank, for the sums over all ranks.
struct RankResult {
    std::uint64_t collisions = 0;
    bool truncated = false;
};
struct Work {
    std::uint64_t in = 0, out = 0, undecided = 0;
    double seconds = 0;
};

}  // namespace

RankFilters::RankFilters(const DetectRequest& request, Cluster& cluster, const SetPair& sets,
                         const std::stop_token& stop)
    : cluster_(cluster) {
    cluster_.together([&] { filters_ = make_filter_chain(request, sets, stop); });
}

PipelineSummary RankFilters::run(const PairList& pairs, const Options& options, CollisionPiece* kept) {
    PipelineSummary summary;
    double seconds = 0;
    {
        const Timed timed(seconds);  // includes waiting for the slowest rank
        const CollisionSink keep = [&](const Batch& batch) { kept->add(batch.pairs(), batch.findings()); };
        // Each rank may stop at the limit by itself: the piece of one rank has no more collisions than the whole result.
        cluster_.together(
            [&] { summary = filters_->filter(pairs, kept != nullptr ? keep : CollisionSink(), options); });
        const std::uint64_t own = join(summary, options);
        if (kept != nullptr) {
            kept->cut(own);
            summary.of_class = kept->of_class();
        }
        add_classes(summary);
    }
    summary.seconds = seconds;
    return summary;
}

/// Sums the classes of all ranks. They are unknown if the limit left out collisions that no rank keeps.
void RankFilters::add_classes(PipelineSummary& summary) {
    const auto of_ranks = cluster_.all_gather(summary.of_class);
    summary.of_class = {};
    std::uint64_t all = 0;
    for (const auto& own : of_ranks) {
        for (std::size_t i = 0; i < own.size(); ++i) all += own[i], summary.of_class[i] += own[i];
    }
    if (all != summary.collisions) summary.of_class = {};
}

std::uint64_t RankFilters::join(PipelineSummary& summary, const Options& options) {
    const std::uint64_t limit = options.limit.value_or(std::numeric_limits<std::uint64_t>::max());
    const std::vector<RankResult> results = cluster_.all_gather(RankResult{summary.collisions, summary.truncated});
    std::uint64_t before = 0, all = 0;
    for (unsigned rank = 0; rank < cluster_.ranks(); ++rank) {
        if (rank == cluster_.rank()) before = all;
        all += results[rank].collisions;
        summary.truncated |= results[rank].truncated;
    }
    summary.truncated |= all > limit;
    summary.collisions = std::min(all, limit);

    std::vector<Work> own;
    own.reserve(summary.filters.size());
    for (const FilterCounts& filter : summary.filters)
        own.push_back({filter.in, filter.out, filter.undecided, filter.seconds});
    const std::vector<Work> works = cluster_.all_gather(std::span<const Work>(own));
    for (std::size_t i = 0; i < works.size(); ++i) {
        if (i / own.size() == cluster_.rank()) continue;
        FilterCounts& counts = summary.filters[i % own.size()];
        counts.in += works[i].in;
        counts.out += works[i].out;
        counts.undecided += works[i].undecided;
        counts.seconds += works[i].seconds;
    }
    return limit - std::min(limit, before);
}

}  // namespace octopair::cli
