// The search of one process: pairs, or the collisions that filters let through, go to the output as they are found.

#include <functional>
#include <optional>
#include <vector>

#include "base/timed.hpp"
#include "cli/detect/filter_chain.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/detect/collision_check.hpp"
#endif
#include "cli/detect/frame_search.hpp"
#include "cli/output/found_writer.hpp"

namespace octopair::cli {

namespace {

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
        timed_write([&] { writer_->finish(); });
        run_.report.changes = writer_->changes();
    }

private:
    void find(std::uint64_t frame) {
        const Options options = run_.call_options(frame);
        if (filters_ != nullptr) return find_collisions(frame, options);
        const double written_before = run_.report.seconds.write;
        const Input input(run_.inputs.first.frame(frame),
                          run_.join() ? std::optional(run_.inputs.second.frame(frame)) : std::nullopt);
        const Summary summary = engine_->stream_pairs(input, pair_sink(), options, run_.stop);
        run_.report.add(summary, run_.report.seconds.write - written_before);
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
        if (run_.request.verify && !check && stage_of(run_.request) != Stage::pairs)
            run_.report.add_not_checked("collisions of triangles");
        if (!check) return;
        const Timed timed(run_.report.seconds.verify);
        run_.progress.show("verifying", 0);
        const std::vector<Pair> excluded = filters_->excluded(*engine_, frame);
        const StageCheck::Result result = check->finish(excluded);
        run_.report.collisions_verified = result.judged;
        if (!excluded.empty()) run_.report.add_not_checked("exclusion rules");
        for (const std::string& what : result.not_checked) run_.report.add_not_checked(what);
    }
#else
    void find_collisions(std::uint64_t, const Options&) {
    }  // a program without filters refuses the options that need them
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
    std::unique_ptr<FilterChain> filters_;  // none: pairs as they are
    std::unique_ptr<FoundWriter> writer_;   // none: pairs are only counted
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
