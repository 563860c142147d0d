// Scenes of files: boxes and meshes, and the pairs that a search finds or a result has.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/timed.hpp"
#include "cli/detect/pipeline_options.hpp"
#include "cli/input/search_inputs.hpp"
#include "cli/view/shown_scene.hpp"
#include "cli/view/view.hpp"
#include "io/files/failure.hpp"
#include "io/results/result_file.hpp"
#include "octopair/engine.hpp"
#include "octopair/error.hpp"
#include "octopair/pair_list.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/detect/filter_chain.hpp"
#include "cli/input/shaped_set.hpp"
#endif

namespace octopair::cli {

namespace {

constexpr std::uint64_t max_pairs = 20'000'000;  ///< per frame, 160 MB; the page has a notice if there are more

/// Inputs of a scene, with which its finder lives. Not movable, because the sets borrow from `padding`.
struct Inputs {
    Inputs(DetectRequest asked, std::stop_token stopped) : request(std::move(asked)), stop(std::move(stopped)) {}
    Inputs(const Inputs&) = delete;
    Inputs& operator=(const Inputs&) = delete;

    DetectRequest request;
    InputSet first, second;  ///< `second` is empty unless the search is a join
    std::optional<Paddings> padding;
    io::FrameCount frames;
    std::stop_token stop;

    SetPair sets() const { return {first, request.against.empty() ? nullptr : &second}; }
};

void add_step_facts(std::vector<viewer::Fact>& facts, const Summary& summary) {
    facts.push_back({"entries", double(summary.entries)});
    facts.push_back({"seconds.detect", summary.seconds});
    facts.push_back({"seconds.encode", summary.steps.encode});
    facts.push_back({"seconds.count", summary.steps.count});
    facts.push_back({"seconds.scatter", summary.steps.scatter});
    facts.push_back({"seconds.scan", summary.steps.scan});
}

class SearchFinder final : public viewer::FrameFinder {
public:
    explicit SearchFinder(std::shared_ptr<const Inputs> inputs)
        : inputs_(std::move(inputs)), engine_(make_engine(inputs_->request.engine)) {
#ifdef OCTOPAIR_WITH_PIPELINE
        const DetectRequest& request = inputs_->request;
        if (has_filters(request)) filters_ = make_filter_chain(request, inputs_->sets(), inputs_->stop);
#endif
    }

    std::uint64_t frames() const override { return inputs_->frames.frames; }

    viewer::FrameData find(std::uint64_t frame, const ProgressSink& progress) override {
        viewer::FrameData data;
        const SetPair sets = inputs_->sets();
        show_boxes(data, sets, frame);
        Options options;
        options.margin = inputs_->request.margin;
        options.limit = max_pairs;
        options.progress = progress;
        try {
            search(frame, options, data);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::bad_input) throw;
            for (const InputSet* set : {&sets.first, sets.second}) {
                const auto invalid = set == nullptr ? std::nullopt : set->find_invalid_box();
                if (invalid) throw Error(ErrorCode::bad_input, invalid->message);
            }
            throw;
        }
        for (Pair& pair : data.pairs) pair.b += second_offset(sets);
        return data;
    }

private:
    void search(std::uint64_t frame, const Options& options, viewer::FrameData& data) {
#ifdef OCTOPAIR_WITH_PIPELINE
        if (filters_ != nullptr) {
            const auto keep = [&](const Batch& batch) {
                data.pairs.insert(data.pairs.end(), batch.pairs().begin(), batch.pairs().end());
                data.findings.insert(data.findings.end(), batch.findings().begin(), batch.findings().end());
            };
            const PipelineSummary summary = filters_->run(*engine_, frame, keep, options);
            data.pair_count = summary.collisions;
            data.more_pairs = summary.truncated;
            add_step_facts(data.facts, summary.search);
            data.facts.push_back({"candidates", double(summary.search.pairs)});
            data.facts.push_back({"seconds.filter", std::max(0.0, summary.seconds - summary.search.seconds)});
            return;
        }
#endif
        const SetPair sets = inputs_->sets();
        const Input input{sets.first.frame(frame),
                          sets.second == nullptr ? std::nullopt : std::optional(sets.second->frame(frame))};
        const Summary summary = engine_->find_pairs(input, list_, options, inputs_->stop);
        data.pairs = list_.to_vector();
        data.pair_count = summary.pairs;
        data.more_pairs = summary.truncated;
        add_step_facts(data.facts, summary);
    }

    std::shared_ptr<const Inputs> inputs_;
    std::unique_ptr<Engine> engine_;
    PairList list_;
#ifdef OCTOPAIR_WITH_PIPELINE
    std::unique_ptr<FilterChain> filters_;
#endif
};

/// The pairs of a result, on the boxes of a scene.
class ResultFinder final : public viewer::FrameFinder {
public:
    ResultFinder(std::shared_ptr<const Inputs> inputs, io::ResultFile result)
        : inputs_(std::move(inputs)), result_(std::move(result)) {}

    std::uint64_t frames() const override { return inputs_->frames.frames; }

    viewer::FrameData find(std::uint64_t frame, const ProgressSink&) override {
        viewer::FrameData data;
        show_boxes(data, inputs_->sets(), frame);
        if (frame < result_.first_frame) return data;
        io::ResultFrame found = result_.frames.frame(frame - result_.first_frame);
        data.pairs = std::move(found.pairs);
        data.findings = std::move(found.findings);
        data.pair_count = data.pairs.size();
        return data;
    }

private:
    std::shared_ptr<const Inputs> inputs_;
    io::ResultFile result_;
};

/// Throws: Error{bad_input} if a result has objects or frames that a scene does not have.
void check_result(const io::ResultFile& result, const Inputs& inputs, const std::string& path) {
    if (const std::uint64_t objects = inputs.first.scene.objects; result.objects > objects) {
        io::refuse(path, fmt::format("object {}: the scene has only {} objects; is it the scene of this result?",
                                     result.objects - 1, objects));
    }
    const std::uint64_t frames = inputs.frames.frames, last = result.first_frame + result.frames.size() - 1;
    if (last >= frames) io::refuse(path, fmt::format("frame {}: the last frame of the scene is {}", last, frames - 1));
    if (!result.moving && frames > 1) {
        io::refuse(path, fmt::format("which of the {} frames of the scene is this? The rows have no frames, and the "
                                     "file's name does not end with the number of one, as pairs.000003.npy does",
                                     frames));
    }
}

/// Reads the files of the request.
void read(Inputs& inputs, ProgressLine& progress) {
    const DetectRequest& request = inputs.request;
    io::SceneContent content{.objects = request.mesh_objects,
                             .progress = [&](double done) { progress.show("reading", done); },
                             .reader = reader_of(request)};
#ifdef OCTOPAIR_WITH_PIPELINE
    content.shapes = true;
#endif
    inputs.first = read_input_set(request.inputs, content, inputs.stop);
    content.unit = inputs.first.scene.space.unit;
    if (!request.against.empty()) inputs.second = read_input_set({request.against}, content, inputs.stop);
    const io::LoadedScene &a = inputs.first.scene, &b = inputs.second.scene;
    // Pages read boxes later, when the mapped file may have changed.
    for (InputSet* set : {&inputs.first, &inputs.second}) set->scene.copy_mapped();
#ifdef OCTOPAIR_WITH_PIPELINE
    make_shaped(inputs.first, inputs.second, {local_threads(request.engine), request.pipeline.weld.value_or(0)},
                inputs.stop);
#endif
    inputs.frames = joint_frames({a.frames, a.moving}, {b.frames, b.moving}, request);
    inputs.padding.emplace(request, SetSizes{a.objects, b.objects}, inputs.stop);
    if (request.padding.empty()) return;
    inputs.first.padding = inputs.padding->inputs();
    inputs.second.padding = inputs.padding->against();
}

}  // namespace

LoadedView load_scene(const ViewRequest& request, ProgressLine& progress, const std::stop_token& stop) {
    const auto inputs = std::make_shared<Inputs>(request.detect, stop);
    double read_seconds = 0;
    {
        const Timed timed(read_seconds);
        read(*inputs, progress);
    }
    if (inputs->frames.frames == 0) io::refuse(request.detect.inputs.front(), "the scene has no frames");
    LoadedView view;
    view.contents = shown_scene(inputs->request, inputs->sets());
    view.contents.facts.push_back({"seconds.read", read_seconds});
    if (request.result.empty()) {
        progress.show("preparing", 0);
        view.finder = std::make_unique<SearchFinder>(inputs);
        return view;
    }
    io::ResultFile result = io::read_result(request.result, stop);
    if (!inputs->frames.moving) result.first_frame = 0;  // a number in the file name is then no frame number
    check_result(result, *inputs, request.result);
    view.contents.contacts = result.frames.has_contacts();
    view.finder = std::make_unique<ResultFinder>(inputs, std::move(result));
    return view;
}

}  // namespace octopair::cli
