#include "cli/detect/event_detection.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "base/timed.hpp"
#include "cli/command/progress_line.hpp"
#include "cli/input/frame_set.hpp"
#include "cli/input/search_inputs.hpp"
#include "io/files/atomic_file.hpp"
#include "io/results/pair_writer.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

/// Runs `work`, and adds its duration to `seconds`.
template <typename Work>
void timed(double& seconds, const Work& work) {
    const Timed timing(seconds);
    work();
}

class EventDetection {
public:
    EventDetection(const DetectRequest& request, RankedEngine ranked, std::stop_token stop)
        : request_(request), ranked_(std::move(ranked)), stop_(std::move(stop)), progress_(!request.quiet) {}

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
        inputs_.emplace(request_.inputs,
                        io::SceneContent{.objects = request_.mesh_objects, .reader = reader_of(request_)}, stop_);
        io::FrameCount frames = inputs_->frames();
        SetSizes sizes{inputs_->objects(), 0};
        if (!request_.against.empty()) {
            against_.emplace(
                std::vector{request_.against},
                io::SceneContent{
                    .objects = request_.mesh_objects, .unit = inputs_->unit(), .reader = reader_of(request_)},
                stop_);
            frames = joint_frames(frames, against_->frames(), request_);
            sizes.against = against_->objects();
        }
        if (request_.fail_on_collision) {
            refuse_empty_parts(inputs_->parts());
            if (against_) refuse_empty_parts(against_->parts());
        }
        paddings_.emplace(request_, sizes, stop_);
        report_.frames = frames.frames;
        report_.moving = frames.moving;
        report_.objects = sizes.inputs + sizes.against;
        report_.engine = describe_engine(request_.engine);
        if (ranked_.engine) report_.engine.ranks = ranked_.ranks;
    }

    template <typename Real>
    void find() {
        const FrameSets sets{*inputs_, against_ ? &*against_ : nullptr, *paddings_};
        const auto make_source = [&] {
            if (ranked_.engine) return make_engine_events<Real>(sets, request_, std::move(ranked_.engine));
            if (request_.engine.keeps_scenes()) return make_scene_events<Real>(sets, request_);
            return make_engine_events<Real>(sets, request_, make_engine(request_.engine));
        };
        const std::unique_ptr<EventSource> source = make_source();
        check_frames(*source);
        open_writer();
        for (std::uint64_t frame = 0; frame < report_.frames && !report_.truncated; ++frame) {
            progress_.show("detecting", double(frame) / double(report_.frames));
            timed(report_.seconds.read, [&] { source->read(frame, stop_); });
            FrameEvents events;
            timed(report_.seconds.detect, [&] { events = source->find(stop_); });
            timed(report_.seconds.write, [&] { write(frame, events); });
        }
        progress_.clear();
        timed(report_.seconds.write, [&] { writer_->finish(); });
    }

    /// Reads all frames once, so that invalid input is found before the first row is written. Only standard output needs this: an
    /// output file is removed after an error.
    void check_frames(EventSource& source) {
        if (!request_.output.empty() || report_.frames < 2) return;
        timed(report_.seconds.read, [&] {
            for (std::uint64_t frame = 0; frame < report_.frames; ++frame) {
                progress_.show("checking", double(frame) / double(report_.frames));
                source.read(frame, stop_);
            }
        });
    }

    void open_writer() {
        const io::PairNames names{&inputs_->names(), against_ ? &against_->names() : &inputs_->names()};
        if (request_.output.empty()) {
            writer_.emplace(io::ResultFormat::csv, std::make_unique<io::StandardOutput>(stop_), names);
        } else {
            writer_.emplace(io::event_format(request_.output), std::make_unique<io::AtomicFile>(request_.output),
                            names);
        }
    }

    void write(std::uint64_t frame, const FrameEvents& events) {
        report_.pairs += events.pairs;
        if (request_.output.empty()) progress_.clear();
        report_.events->ended += write(frame, io::Event::end, events.ended);
        report_.events->began += write(frame, io::Event::begin, events.began);
    }

    /// Writes one row per pair, until the limit of --limit is reached. Returns the number of rows written.
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
            writer_->write(frame, event, pairs.subspan(i, std::min(batch, pairs.size() - i)));
        }
        return pairs.size();
    }

    const DetectRequest& request_;
    RankedEngine ranked_;
    std::stop_token stop_;
    ProgressLine progress_;
    std::optional<FrameSet> inputs_, against_;
    std::optional<Paddings> paddings_;
    std::optional<io::EventWriter> writer_;
    std::uint64_t rows_ = 0;
    DetectReport report_;
};

}  // namespace

void check_event_options(const DetectRequest& request) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::usage, "--events: " + why); };
    if (request.count_only) refuse("not with --count-only");
    if (request.order == Order::octal) refuse("not with --order octal: the pairs of a frame are ascending");
    if (!request.output.empty()) (void)io::event_format(request.output);
}

DetectReport detect_events(const DetectRequest& request, RankedEngine ranked, const std::stop_token& stop) {
    return EventDetection(request, std::move(ranked), stop).run();
}

}  // namespace octopair::cli
