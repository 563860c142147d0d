// The search of ranks (`--engine mpi`): each rank finds its piece of a frame's pairs, filters it, and the pieces of all
// ranks become one result.
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/floating_point_scope.hpp"
#include "base/timed.hpp"
#include "cli/detect/rank_group.hpp"
#include "cli/output/output_room.hpp"
#include "cli/output/piece_output.hpp"
#include "cli/ranks/cluster.hpp"
#include "io/formats/format_choice.hpp"
#include "octopair/error.hpp"
#include "octopair/mpi.hpp"
#include "verification/verifier.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/detect/filter_chain.hpp"
#endif

namespace octopair::cli {

namespace {

/// Returns the objects of `input` without explicit indices: the engine numbers them consecutively from rank to rank.
IndexedInput unindexed(const Input& input) {
    std::optional<IndexedObjects> second;
    if (input.second) second = {*input.second, {}};
    return {IndexedObjects{input.first, {}}, second};
}

#ifdef OCTOPAIR_WITH_PIPELINE
/// Filters on MPI ranks. Each rank has all objects, and filters its own piece of the pairs. All functions are collective. An exception is
/// thrown on all ranks.
class RankFilters {
public:
    /// Borrows all parameters. Requires: `sets` hold all objects, not slices.
    RankFilters(const DetectRequest& request, Cluster& cluster, const SetPair& sets, const std::stop_token& stop);

    /// Filters `pairs`, the piece of this rank, and appends the result to `kept` unless that is null. The limit of `options`
    /// applies to all ranks together. Returns the sums over all ranks, without the search. The seconds are those of this rank.
    PipelineSummary run(const PairList& pairs, const Options& options, CollisionPiece* kept);

    const std::vector<std::string>& warnings() const { return filters_->warnings(); }
    /// Returns the pairs that options have left out on this rank. Requires: the request has --statuses.
    std::span<const Pair> left_out() const { return filters_->left_out(); }

private:
    /// Replaces `summary` by the sums over all ranks. Returns how many collisions this rank keeps under the limit.
    std::uint64_t join(PipelineSummary& summary, const Options& options);
    void add_classes(PipelineSummary& summary);

    Cluster& cluster_;
    std::unique_ptr<FilterChain> filters_;
};

/// Counts of one rank, which the ranks exchange to compute the sums over all ranks.
struct RankResult {
    std::uint64_t collisions = 0;
    bool truncated = false;
};
struct Work {
    std::uint64_t in = 0, out = 0, undecided = 0;
    double seconds = 0;
};

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
        // Apply the limit to each rank's piece first: no rank needs to keep more collisions than the whole result may have.
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
#endif

class RankedSearch final : public FrameSearch {
public:
    RankedSearch(DetectRun& run, Cluster& cluster) : run_(run), cluster_(cluster) {
        cluster_.joint([&] { engine_ = make_mpi_engine(MPI_COMM_WORLD, {.threads = run.report.engine.threads}); });
    }

    void prepare() override {
#ifdef OCTOPAIR_WITH_PIPELINE
        if (has_filters(run_.request)) {
            const Timed timed(run_.report.seconds.prepare);
            run_.progress.show("preparing", 0);
            filters_.emplace(run_.request, cluster_,
                             SetPair{run_.inputs.first, run_.join() ? &run_.inputs.second : nullptr}, run_.stop);
            run_.report.add_warnings(filters_->warnings());
        }
#endif
        if (run_.request.count_only) return;
        output_ = make_piece_output(run_.request, cluster_,
                                    {run_.inputs.first, run_.second_or_first(), run_.report.moving}, run_.stop);
    }

    void search(std::uint64_t frame) override {
        if (has_filters(run_.request)) return filter(frame);
        const Summary summary = find(frame);
        run_.report.add(summary, 0);
        if (output_ == nullptr) return;
        cluster_.together([&] {
            if (cluster_.first()) room_.require(summary.pairs);
        });
        run_.progress.clear();
        const Timed timed(run_.report.seconds.write);
        has_wide_indices(run_) ? output_->write(frame, wide_piece_) : output_->write(frame, piece_);
    }

    void finish() override {
        if (output_ == nullptr) return;
        const Timed timed(run_.report.seconds.write);
        output_->finish(!run_.report.truncated);
        run_.report.changes = output_->changes();
        run_.report.statuses = output_->statuses();
    }

private:
#ifdef OCTOPAIR_WITH_PIPELINE
    void filter(std::uint64_t frame) {
        const Summary found = find(frame);
        CollisionPiece kept;
        Options options = run_.call_options(frame);
        options.progress = [&](double done) { run_.progress.show("filtering", done); };
        PipelineSummary summary = filters_->run(piece_, options, output_ != nullptr ? &kept : nullptr);
        summary.search = found;
        summary.seconds += found.seconds + found.verification.seconds;
        run_.report.add(summary, 0);
        if (run_.request.verify && stage_of(run_.request) != Stage::pairs)
            run_.report.add_not_checked("collisions on ranks");
        if (output_ == nullptr) return;
        run_.progress.clear();
        const Timed timed(run_.report.seconds.write);
        output_->write(frame, kept);
        if (!run_.request.pipeline.statuses.empty()) output_->leave_out(filters_->left_out());
    }
#else
    void filter(std::uint64_t) {}  // a build without the pipeline refuses the options that need filters
#endif

    /// Finds this rank's piece of a frame's pairs. Without output and filters it only counts them.
    Summary find(std::uint64_t frame) {
        Summary summary = find_piece(frame);
        cluster_.together([&] { run_.check_inputs(); });
        if (run_.request.verify) verify(frame, summary);
        return summary;
    }

    bool counts_only() const { return output_ == nullptr && !has_filters(run_.request); }

    Summary find_piece(std::uint64_t frame) {
        const Input input(own_objects(run_.inputs.first, frame),
                          run_.join() ? std::optional(own_objects(run_.inputs.second, frame)) : std::nullopt);
        Options options = run_.call_options(frame);
        options.verify = false;                                // the engine has a slice; verify() checks all objects
        if (has_filters(run_.request)) options.limit.reset();  // --limit limits the collisions, not the pairs of boxes
        Summary summary;
        cluster_.joint([&] {
            if (has_wide_indices(run_)) {
                summary = find_pairs64(*engine_, unindexed(input), wide_piece_, options, run_.stop);
            } else if (counts_only()) {
                summary = engine_->stream_pairs(input, {}, options, run_.stop);
            } else {
                summary = list_pairs(input, options);
            }
        });
        return summary;
    }

    Summary list_pairs(const Input& input, const Options& options) {
        try {
            return engine_->find_pairs(input, piece_, options, run_.stop);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::resource_limit) throw;
            throw in_words_of_command(error);
        }
    }

    /// Returns the objects of a frame that this rank gives to the engine.
    Objects own_objects(const InputSet& set, std::uint64_t frame) const {
        return needs_whole_inputs(run_.request) ? set.frame_slice(frame, own_slice(cluster_)) : set.frame(frame);
    }

    /// Collects the pairs of all ranks (or their number) on the first rank, which checks them against all objects.
    void verify(std::uint64_t frame, Summary& summary) {
        const FloatingPointScope scope;
        const Objects first = run_.inputs.first.frame(frame), second = run_.inputs.second.frame(frame);
        const Options options = run_.call_options(frame);
        const ResultKind ordered = options.order == Order::octal ? ResultKind::octal : ResultKind::ascending;
        Verifier verifier({.objects = {first, run_.join() ? &second : nullptr, options.margin},
                           .kind = counts_only() ? ResultKind::count : ordered,
                           .limit = options.limit,
                           .threads = run_.report.engine.threads,
                           .stop = run_.stop});
        if (!counts_only()) cluster_.relay(piece_, [&](std::span<const Pair> pairs) { verifier.take(pairs); });
        cluster_.together([&] {
            if (!cluster_.first()) return;
            try {
                summary.verification = verifier.finish({summary.pairs, summary.truncated});
            } catch (const Error&) {
                run_.check_inputs();  // if an input file changed, reports the change instead
                throw;
            }
        });
    }

    DetectRun& run_;
    Cluster& cluster_;
    std::unique_ptr<Engine> engine_;
    PairList piece_;
    std::vector<Pair64> wide_piece_;
    std::unique_ptr<PieceOutput> output_;  // null: pairs are only counted
    OutputRoom room_{run_.request, has_wide_indices(run_) ? sizeof(Pair64) : sizeof(Pair)};
#ifdef OCTOPAIR_WITH_PIPELINE
    std::optional<RankFilters> filters_;
#endif
};

}  // namespace

std::unique_ptr<FrameSearch> make_ranked_search(DetectRun& run, Cluster& cluster) {
    return std::make_unique<RankedSearch>(run, cluster);
}

}  // namespace octopair::cli
