#include "cli/event_detection.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "cli/frame_set.hpp"
#include "cli/join.hpp"
#include "cli/progress_line.hpp"
#include "io/atomic_file.hpp"
#include "io/event_writer.hpp"
#include "octopair/error.hpp"
#include "octopair/scene.hpp"

namespace octopair::cli {

namespace {

/// Adds the time that `work` takes.
template <typename Work>
void timed(double& seconds, const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A set of objects in a scene, and their boxes in this frame and the one before.
template <typename Real>
class MovingObjects {
public:
    explicit MovingObjects(const FrameSet& set)
        : set_(set), now_(std::size_t(set.objects())), ids_(std::size_t(set.objects())) {}

    void read(std::uint64_t frame, const std::stop_token& stop) {
        if (frame > 0 && !set_.frames().moving) return;
        std::swap(now_, before_);
        now_.resize_discard(ids_.size());
        set_.read(frame, now_.span(), stop);
    }

    void add(Scene& scene, std::span<const double> padding, std::span<const Traits> traits) {
        scene.add({std::span<const Box<Real>>(now_.span()), padding}, ids_, traits);
    }

    /// Those whose boxes differ from the frame before, a run at a time.
    void move(Scene& scene) const {
        if (!set_.frames().moving) return;
        for (std::size_t begin = 0; begin < ids_.size(); ++begin) {
            std::size_t end = begin;
            while (end < ids_.size() && differs(end)) ++end;
            if (end == begin) continue;
            scene.move(std::span(ids_).subspan(begin, end - begin), now_.span().subspan(begin, end - begin));
            begin = end;  // which does not differ
        }
    }

private:
    bool differs(std::size_t i) const {
        const Box<Real>&now = now_[i], &before = before_[i];
        return !std::equal(now.min, now.min + 3, before.min) || !std::equal(now.max, now.max + 3, before.max);
    }

    const FrameSet& set_;
    Buffer<Box<Real>> now_, before_;
    std::vector<ObjectId> ids_;
};

/// The files' objects in a scene. A new scene numbers objects in the order in which they are added: the inputs', then
/// those of the other set.
template <typename Real>
class SceneOfFiles {
public:
    SceneOfFiles(const FrameSet& inputs, const FrameSet* against, const SceneOptions& options)
        : inputs_(inputs), scene_(options) {
        if (against != nullptr) against_.emplace(*against);
    }

    void read(std::uint64_t frame, const std::stop_token& stop) {
        inputs_.read(frame, stop);
        if (against_) against_->read(frame, stop);
    }

    /// After the first frame was read.
    void add(const Paddings& paddings) {
        if (!against_) return inputs_.add(scene_, paddings.inputs(), {});
        // Objects of one set pair with those of the other alone.
        inputs_.add(scene_, paddings.inputs(), std::array{Traits{.groups = 1, .mask = 2}});
        against_->add(scene_, paddings.against(), std::array{Traits{.groups = 2, .mask = 1}});
    }

    /// After a further one was read.
    void move() {
        inputs_.move(scene_);
        if (against_) against_->move(scene_);
    }

    const StepResult& step(const std::stop_token& stop) { return scene_.step(stop); }

private:
    MovingObjects<Real> inputs_;
    std::optional<MovingObjects<Real>> against_;
    Scene scene_;
};

class EventDetection {
public:
    EventDetection(const DetectRequest& request, std::stop_token stop)
        : request_(request), stop_(std::move(stop)), progress_(!request.quiet) {}

    DetectReport run() {
        report_.events.emplace();
        timed(report_.seconds.total, [&] {
            timed(report_.seconds.read, [&] { open_inputs(); });
            const bool wide = inputs_->wide() || (against_ && against_->wide());
            wide ? find<double>() : find<float>();
        });
        return report_;
    }

private:
    void open_inputs() {
        progress_.show("reading", 0);
        inputs_.emplace(request_.inputs, request_.mesh_objects, stop_);
        io::FrameCount frames = inputs_->frames();
        SetSizes sizes{inputs_->objects(), 0};
        if (!request_.against.empty()) {
            against_.emplace(std::vector{request_.against}, request_.mesh_objects, stop_);
            frames = joint_frames(frames, against_->frames(), request_);
            sizes.against = against_->objects();
        }
        paddings_.emplace(request_, sizes, stop_);
        report_.frames = frames.frames;
        report_.moving = frames.moving;
        report_.objects = sizes.inputs + sizes.against;
        report_.crew = crew_of(request_.engine);
    }

    template <typename Real>
    void find() {
        constexpr Precision precision = sizeof(Real) == sizeof(float) ? Precision::float32 : Precision::float64;
        SceneOfFiles<Real> scene(*inputs_, against_ ? &*against_ : nullptr,
                                 {request_.engine.threads.value_or(0), precision, request_.margin});
        check_frames(scene);
        open_writer();
        for (std::uint64_t frame = 0; frame < report_.frames && !report_.truncated; ++frame) {
            progress_.show("detecting", double(frame) / double(report_.frames));
            timed(report_.seconds.read, [&] { scene.read(frame, stop_); });
            const StepResult* step = nullptr;
            timed(report_.seconds.detect, [&] {
                frame == 0 ? scene.add(*paddings_) : scene.move();
                step = &scene.step(stop_);
            });
            timed(report_.seconds.write, [&] { write(frame, *step); });
        }
        progress_.clear();
        timed(report_.seconds.write, [&] { writer_->finish(); });
    }

    /// A file appears whole or not at all; standard output must not begin before all frames are known to be good.
    template <typename Real>
    void check_frames(SceneOfFiles<Real>& scene) {
        if (!request_.output.empty() || report_.frames < 2) return;
        timed(report_.seconds.read, [&] {
            for (std::uint64_t frame = 0; frame < report_.frames; ++frame) {
                progress_.show("checking", double(frame) / double(report_.frames));
                scene.read(frame, stop_);
            }
        });
    }

    void open_writer() {
        const io::PairNames names{&inputs_->names(), against_ ? &against_->names() : &inputs_->names()};
        if (request_.output.empty()) {
            writer_.emplace(io::PairFormat::csv, std::make_unique<io::StandardOutput>(stop_), names);
        } else {
            writer_.emplace(io::event_format(request_.output), std::make_unique<io::AtomicFile>(request_.output),
                            names);
        }
    }

    void write(std::uint64_t frame, const StepResult& step) {
        report_.pairs += step.pairs();
        if (request_.output.empty()) progress_.clear();
        report_.events->ended += write(frame, io::Event::end, step.ended);
        report_.events->began += write(frame, io::Event::begin, step.began);
    }

    /// Tells how many.
    std::uint64_t write(std::uint64_t frame, io::Event event, std::span<const Pair> pairs) {
        if (request_.limit) {
            const std::uint64_t left = *request_.limit - rows_;
            report_.truncated |= pairs.size() > left;
            pairs = pairs.first(std::size_t(std::min<std::uint64_t>(left, pairs.size())));
        }
        rows_ += pairs.size();
        constexpr std::size_t batch = 4096;
        for (std::size_t i = 0; i < pairs.size(); i += batch) {
            if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "interrupted");
            writer_->write(frame, event, in_own_set(pairs.subspan(i, std::min(batch, pairs.size() - i))));
        }
        return pairs.size();
    }

    /// Of a join, b is numbered within its own set.
    std::span<const Pair> in_own_set(std::span<const Pair> pairs) {
        if (!against_) return pairs;
        const auto first = std::uint32_t(inputs_->objects());
        renumbered_.clear();
        for (const auto [a, b] : pairs) renumbered_.push_back({a, b - first});
        return renumbered_;
    }

    const DetectRequest& request_;
    std::stop_token stop_;
    ProgressLine progress_;
    std::optional<FrameSet> inputs_, against_;
    std::optional<Paddings> paddings_;
    std::optional<io::EventWriter> writer_;
    std::vector<Pair> renumbered_;
    std::uint64_t rows_ = 0;
    DetectReport report_;
};

}  // namespace

void check_event_options(const DetectRequest& request) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::usage, "--events: " + why); };
    if (request.engine.kind != EngineKind::local) {
        refuse("not with --engine processes: they come from a scene, which the local engine alone keeps");
    }
    if (request.count_only) refuse("not with --count-only");
    if (request.order == Order::octal) refuse("not with --order octal: the pairs of a frame are ascending");
    if (!request.output.empty()) (void)io::event_format(request.output);
}

DetectReport detect_events(const DetectRequest& request, const std::stop_token& stop) {
    return EventDetection(request, stop).run();
}

}  // namespace octopair::cli
