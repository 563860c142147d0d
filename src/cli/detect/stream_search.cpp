// The search of one process: pairs, or the collisions that filters let through, go to the output as they are found.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "base/timed.hpp"
#include "cli/detect/filter_chain.hpp"
#include "cli/detect/frame_search.hpp"
#include "cli/detect/pipeline_options.hpp"
#include "cli/output/found_writer.hpp"
#include "cli/output/output_room.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/input/shaped_set.hpp"
#include "verification/shapes/stage_check.hpp"
#endif

namespace octopair::cli {

namespace {

#ifdef OCTOPAIR_WITH_PIPELINE
/// Checks the collisions of one frame by certificates (--verify with an exact stage).
class CollisionCheck {
public:
    /// Borrows the request and the sets.
    CollisionCheck(const DetectRequest& request, const SetPair& sets, std::uint64_t frame, std::stop_token stop);
    CollisionCheck(const CollisionCheck&) = delete;
    CollisionCheck& operator=(const CollisionCheck&) = delete;

    /// Takes the next collisions of the frame.
    void take(const Batch& batch) { check_->take(batch.pairs(), batch.findings()); }
    void take(const LeftOut& left_out) { check_->take(left_out.pairs, left_out.findings); }
    /// Checks all collisions of the frame. `excluded`: the pairs that exclusion rules leave out. Throws: as StageCheck::finish().
    StageCheck::Result finish(std::span<const Pair> excluded);

private:
    Objects first_boxes_, second_boxes_;
    ShapedObjects first_, second_;
    std::unique_ptr<StageCheck> check_;
};

CollisionCheck::CollisionCheck(const DetectRequest& request, const SetPair& sets, std::uint64_t frame,
                               std::stop_token stop) {
    const bool join = sets.second != nullptr;
    first_boxes_ = sets.first.frame(frame);
    first_ = sets.first.shaped->objects(sets.first.padding);
    if (join) {
        second_boxes_ = sets.second->frame(frame);
        second_ = sets.second->shaped->objects(sets.second->padding);
    }
    const StageRules rules{request.margin, tolerance_of(request, sets), stage_of(request) == Stage::features,
                           request.pipeline.min_depth};
    check_ =
        std::make_unique<StageCheck>(StageCheck::Setup{{first_boxes_, join ? &second_boxes_ : nullptr, request.margin},
                                                       first_,
                                                       join ? &second_ : nullptr,
                                                       rules,
                                                       local_threads(request.engine),
                                                       std::move(stop)});
}

StageCheck::Result CollisionCheck::finish(std::span<const Pair> excluded) {
    check_->exclude(excluded);
    return check_->finish();
}
#endif

class StreamSearch final : public FrameSearch {
public:
    explicit StreamSearch(DetectRun& run) : run_(run), engine_(make_engine(run.request.engine)) {}

    void prepare() override {
#ifdef OCTOPAIR_WITH_PIPELINE
        if (has_filters(run_.request)) {
            const Timed timed(run_.report.seconds.prepare);
            run_.progress.show("preparing", 0);
            filters_ = make_filter_chain(run_.request, {run_.inputs.first, run_.join() ? &run_.inputs.second : nullptr},
                                         run_.stop);
            run_.report.add_warnings(filters_->warnings());
        }
#endif
        if (run_.request.count_only) return;
        writer_ =
            make_found_writer(run_.request, {run_.inputs.first, run_.second_or_first(), run_.report.moving}, run_.stop);
    }

    void search(std::uint64_t frame) override {
        if (writer_ != nullptr) timed_write([&] { writer_->begin_frame(frame); });
        find(frame);
        run_.check_inputs();
        if (writer_ == nullptr) return;
        run_.progress.clear();
        timed_write([&] { writer_->end_frame(); });
    }

    void finish() override {
        if (writer_ == nullptr) return;
        timed_write([&] { writer_->finish(!run_.report.truncated); });
        run_.report.changes = writer_->changes();
        run_.report.statuses = writer_->statuses();
    }

private:
    void find(std::uint64_t frame) {
        const Options options = run_.call_options(frame);
        if (filters_ != nullptr) return find_collisions(frame, options);
        const std::optional<std::uint64_t> most = writer_ != nullptr ? room_.max_pairs() : std::nullopt;
        const double written_before = run_.report.seconds.write;
        const Input input(run_.inputs.first.frame(frame),
                          run_.join() ? std::optional(run_.inputs.second.frame(frame)) : std::nullopt);
        try {
            const Summary summary = most ? engine_->stream_at_most(*most, input, pair_sink(), options, run_.stop)
                                         : engine_->stream_pairs(input, pair_sink(), options, run_.stop);
            run_.report.add(summary, run_.report.seconds.write - written_before);
        } catch (const TooManyPairs& excess) {
            room_.refuse(excess);
        }
    }

#ifdef OCTOPAIR_WITH_PIPELINE
    void find_collisions(std::uint64_t frame, const Options& options) {
        const double written_before = run_.report.seconds.write;
        std::optional<CollisionCheck> check;
        const InputSet* const second = run_.join() ? &run_.inputs.second : nullptr;
        const bool has_shapes = run_.inputs.first.shaped != nullptr && stage_of(run_.request) != Stage::pairs;
        if (run_.request.verify && has_shapes)
            check.emplace(run_.request, SetPair{run_.inputs.first, second}, frame, run_.stop);
        const CollisionSink sink = [&](const Batch& batch) {
            if (check) check->take(batch);
            if (writer_ == nullptr) return;
            timed_write([&] { writer_->write(batch.pairs(), batch.findings()); });
        };
        const bool counts_only = writer_ == nullptr && !check;
        const PipelineSummary summary = filters_->run(*engine_, frame, counts_only ? CollisionSink() : sink, options);
        run_.report.add(summary, run_.report.seconds.write - written_before);
        if (writer_ != nullptr) timed_write([&] { writer_->leave_out(filters_->left_out()); });
        if (run_.request.verify && !check && stage_of(run_.request) != Stage::pairs)
            run_.report.add_not_checked("collisions of triangles");
        if (!check) return;
        const Timed timed(run_.report.seconds.verify);
        run_.progress.show("verifying", 0);
        check->take(filters_->left_out_by_class());
        const std::vector<Pair> excluded = filters_->excluded(*engine_, frame);
        const StageCheck::Result result = check->finish(excluded);
        run_.report.collisions_verified = result.judged;
        if (!excluded.empty()) run_.report.add_not_checked("exclusion rules");
        for (const std::string& what : result.not_checked) run_.report.add_not_checked(what);
    }
#else
    void find_collisions(std::uint64_t, const Options&) {
    }  // a build without the pipeline refuses the options that need filters
#endif

    PairSink pair_sink() {
        if (writer_ == nullptr) return {};
        return [&](std::span<const Pair> pairs) { timed_write([&] { writer_->write(pairs, {}); }); };
    }

    void timed_write(const std::function<void()>& write) {
        const Timed timed(run_.report.seconds.write);
        write();
    }

    DetectRun& run_;
    std::unique_ptr<Engine> engine_;
    std::unique_ptr<FilterChain> filters_;  // null: all pairs are written, without filters
    std::unique_ptr<FoundWriter> writer_;   // null: pairs are only counted
    OutputRoom room_{run_.request};
};

class OneProcess final : public SearchGroup {
public:
    Group& processes() override { return alone_; }
    void read_inputs(DetectRun& run) override { run.inputs.read(run.request, run.progress, run.stop); }
    void check_objects(DetectRun&) override {}
    void compare_inputs(DetectRun&) override {}
    std::unique_ptr<FrameSearch> make_search(DetectRun& run) override { return std::make_unique<StreamSearch>(run); }

private:
    Group alone_;
};

}  // namespace

std::unique_ptr<SearchGroup> one_process() { return std::make_unique<OneProcess>(); }

}  // namespace octopair::cli
