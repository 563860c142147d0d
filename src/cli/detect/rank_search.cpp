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
#include "cli/detect/frame_search.hpp"
#include "cli/detect/rank_facts.hpp"
#include "cli/input/join.hpp"
#include "cli/output/piece_output.hpp"
#include "cli/ranks/cluster.hpp"
#include "io/formats/format_choice.hpp"
#include "octopair/error.hpp"
#include "octopair/mpi.hpp"
#include "verification/verifier.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/detect/rank_filters.hpp"
#endif

namespace octopair::cli {

namespace {

/// Returns the same objects, numbered from rank to rank.
IndexedInput unindexed(const Input& input) {
    std::optional<IndexedObjects> second;
    if (input.second) second = {*input.second, {}};
    return {IndexedObjects{input.first, {}}, second};
}

/// True if indices need more bits than a Pair has, or if the request asks for 64 bits.
bool has_wide_indices(const DetectRun& run) {
    return run.request.wide_indices || run.report.objects > std::numeric_limits<std::uint32_t>::max();
}

/// Returns whether every rank needs all objects. Filters and verification look at any object, and boxes of shapes may depend on all.
bool needs_whole_inputs(const DetectRequest& request) {
    return has_filters(request) || request.verify || io::is_json_file(request.against) ||
           std::any_of(request.inputs.begin(), request.inputs.end(), io::is_json_file);
}

SliceNumber own_slice(const Cluster& cluster) { return {cluster.rank(), cluster.ranks()}; }

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
        }
#endif
        if (run_.request.count_only) return;
        output_ = make_piece_output(run_.request, cluster_,
                                    {run_.inputs.first, run_.second_or_first(), run_.report.moving}, run_.stop);
    }

    void search(std::uint64_t frame) override {
        if (has_filters(run_.request)) return filter(frame);
        run_.report.add(find(frame), 0);
        if (output_ == nullptr) return;
        run_.progress.clear();
        const Timed timed(run_.report.seconds.write);
        has_wide_indices(run_) ? output_->write(frame, wide_piece_) : output_->write(frame, piece_);
    }

    void finish() override {
        if (output_ == nullptr) return;
        const Timed timed(run_.report.seconds.write);
        output_->finish();
        run_.report.changes = output_->changes();
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
    }
#else
    void filter(std::uint64_t) {}  // a program without filters refuses the options that need them
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
        options.verify = false;                                // the engine has slices; verify() has all objects
        if (has_filters(run_.request)) options.limit.reset();  // the limit is one of collisions
        Summary summary;
        cluster_.joint([&] {
            if (has_wide_indices(run_)) {
                summary = find_pairs64(*engine_, unindexed(input), wide_piece_, options, run_.stop);
            } else if (counts_only()) {
                summary = engine_->stream_pairs(input, {}, options, run_.stop);
            } else {
                summary = engine_->find_pairs(input, piece_, options, run_.stop);
            }
        });
        return summary;
    }

    /// Returns the objects of a frame that this rank gives to the engine.
    Objects own_objects(const InputSet& set, std::uint64_t frame) const {
        return needs_whole_inputs(run_.request) ? set.frame_slice(frame, own_slice(cluster_)) : set.frame(frame);
    }

    /// The first rank checks the pairs of all ranks, or their number, on all objects.
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
                run_.check_inputs();  // if boxes changed, this is the reason
                throw;
            }
        });
    }

    DetectRun& run_;
    Cluster& cluster_;
    std::unique_ptr<Engine> engine_;
    PairList piece_;
    std::vector<Pair64> wide_piece_;
    std::unique_ptr<PieceOutput> output_;  // none: pairs are only counted
#ifdef OCTOPAIR_WITH_PIPELINE
    std::optional<RankFilters> filters_;
#endif
};

/// Reads this rank's slice of each set.
void read_slices(DetectRun& run, const Cluster& cluster) {
    const DetectRequest& request = run.request;
    const SliceRequest slice{own_slice(cluster), cluster.first()};
    InputSet &first = run.inputs.first, &second = run.inputs.second;
    first = read_input_slice(request.inputs, {request.mesh_objects}, slice, run.stop);
    if (run.join()) second = read_input_slice({request.against}, {request.mesh_objects}, slice, run.stop);
    run.inputs.frames =
        joint_frames({first.scene.frames, first.scene.moving}, {second.scene.frames, second.scene.moving}, request);
    run.inputs.padding.emplace(request, SetSizes{first.total, second.total}, run.stop);
    const auto own = [](std::span<const double> all, const InputSet& set) {
        return all.empty() ? all : all.subspan(set.begin, set.scene.objects);
    };
    first.padding = own(run.inputs.padding->inputs(), first);
    second.padding = own(run.inputs.padding->against(), second);
}

class RankGroup final : public SearchGroup {
public:
    explicit RankGroup(Cluster& cluster) : cluster_(cluster) {}

    Group& processes() override { return cluster_; }

    void read_inputs(DetectRun& run) override {
        if (needs_whole_inputs(run.request)) return run.inputs.read(run.request, run.progress, run.stop);
        read_slices(run, cluster_);
    }

    void check_objects(DetectRun& run) override {
        run.report.engine.ranks = cluster_.ranks();
        if (!has_wide_indices(run)) return;
        const std::string objects = std::to_string(run.report.objects) + " objects: ";
        if (run.request.verify) throw Error(ErrorCode::resource_limit, objects + "--verify has indices of 32 bits");
        if (has_filters(run.request))
            throw Error(ErrorCode::resource_limit, objects + "filters have indices of 32 bits");
        if (!io::is_array_file(run.request.output) && !run.request.count_only) {
            throw Error(ErrorCode::resource_limit, objects + "indices of 64 bits go to .npy files alone");
        }
    }

    void compare_inputs(DetectRun& run) override {
        const Timed timed(run.report.seconds.read);
        Facts facts;
        cluster_.together([&] { facts = input_facts(run); });
        cluster_.require_same(facts);
    }

    std::unique_ptr<FrameSearch> make_search(DetectRun& run) override {
        return std::make_unique<RankedSearch>(run, cluster_);
    }

private:
    Cluster& cluster_;
};

}  // namespace

std::unique_ptr<SearchGroup> ranks_of(Cluster& cluster) { return std::make_unique<RankGroup>(cluster); }

}  // namespace octopair::cli
