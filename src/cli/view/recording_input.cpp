// Recordings of scenes: each step is a frame.
#include <fmt/format.h>

#include "cli/command/option_values.hpp"
#include "cli/view/view.hpp"
#include "io/files/input_file.hpp"
#include "scene/recording/replay.hpp"

namespace octopair::cli {

namespace {

constexpr std::uint64_t max_bytes = std::uint64_t(2) << 30;  ///< maximum memory of the steps of a recording

/// A step of the recorded scene.
struct RecordedStep {
    std::variant<std::vector<Box3f>, std::vector<Box3d>> boxes;
    std::vector<std::uint8_t> exists;
    std::vector<Pair> pairs;
    double seconds = 0;

    std::uint64_t bytes() const {
        const std::uint64_t of_boxes = std::visit([](const auto& all) { return all.size() * sizeof(all[0]); }, boxes);
        return of_boxes + exists.size() + pairs.size() * sizeof(Pair);
    }
};

RecordedStep step_of(Scene& scene, const StepResult& result) {
    RecordedStep step;
    std::visit([&](auto boxes) { step.boxes = std::vector(boxes.begin(), boxes.end()); }, scene.boxes());
    step.exists.resize(std::size_t(scene.indices()));
    for (std::uint32_t i = 0; i < step.exists.size(); ++i) step.exists[i] = scene.exists(i) ? 1 : 0;
    step.seconds = result.seconds;
    step.pairs = scene.pairs().to_vector();
    return step;
}

class RecordingFinder final : public viewer::FrameFinder {
public:
    /// `objects`: number of objects of each frame. Objects that a step does not have yet are marked as not existing in its frame.
    RecordingFinder(std::vector<RecordedStep> steps, std::uint64_t objects)
        : steps_(std::move(steps)), objects_(objects) {}

    std::uint64_t frames() const override { return steps_.size(); }

    viewer::FrameData find(std::uint64_t frame, const ProgressSink&) override {
        const RecordedStep& step = steps_[std::size_t(frame)];
        viewer::FrameData data;
        const auto boxes = std::make_shared<decltype(step.boxes)>(step.boxes);
        std::visit(
            [&](auto& all) {
                all.resize(std::size_t(objects_));
                data.boxes = std::span<const typename std::decay_t<decltype(all)>::value_type>(all);
            },
            *boxes);
        data.keep = boxes;
        data.exists = step.exists;
        data.exists.resize(std::size_t(objects_), 0);
        data.pairs = step.pairs;
        data.pair_count = step.pairs.size();
        data.facts.push_back({"seconds.step", step.seconds});
        return data;
    }

private:
    std::vector<RecordedStep> steps_;
    std::uint64_t objects_;
};

}  // namespace

bool is_recording(const std::string& path) {
    const io::InputFile file(path, io::InputFile::Changes::allowed);
    std::array<char, 8> magic = {};
    if (file.size() < magic.size()) return false;
    file.read(0, std::as_writable_bytes(std::span(magic)));
    return magic == RecordingHead::right_magic;
}

LoadedView load_recording(const ViewRequest& request, ProgressLine& progress, const std::stop_token& stop) {
    const std::string& path = request.detect.inputs.front();
    const io::InputFile file(path, io::InputFile::Changes::allowed);
    RecordingReader reader(
        {path, file.size(), [&](std::uint64_t offset, std::span<std::byte> out) { file.read(offset, out, stop); }});
    std::vector<RecordedStep> steps;
    std::uint64_t bytes = 0, objects = 0, left_out = 0;
    ReplayOptions options{request.detect.engine.threads.value_or(0)};
    options.on_scene_step = [&](Scene& scene, const StepResult& result) {
        progress.show("replaying", reader.progress());
        if (bytes > max_bytes) {
            ++left_out;
            return;
        }
        steps.push_back(step_of(scene, result));
        bytes += steps.back().bytes();
        objects = std::max(objects, scene.indices());
    };
    const ReplayReport report = replay(reader, options, stop);
    LoadedView view;
    view.contents.title = path.substr(path.rfind('/') + 1);
    view.contents.objects = objects;
    view.contents.moving = true;
    view.contents.margin = reader.options().margin;
    view.contents.up = axis_word(request.detect.pipeline.space.up);
    if (left_out > 0) {
        view.contents.notices.push_back(fmt::format("Only the first {} of {} steps are shown, because of their size.",
                                                    grouped(steps.size()), grouped(steps.size() + left_out)));
    }
    if (report.cut) view.contents.notices.push_back("The recording ends within a call, which is left out.");
    if (report.unfinished) view.contents.notices.push_back("The recording ends within a step, which was run again.");
    if (steps.empty()) steps.emplace_back();
    view.finder = std::make_unique<RecordingFinder>(std::move(steps), objects);
    return view;
}

}  // namespace octopair::cli
