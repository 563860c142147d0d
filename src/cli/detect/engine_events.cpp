// Engine events: finds all pairs of each frame with an engine, and compares them with the pairs of the frame before.
#include <utility>
#include <vector>

#include "cli/detect/event_detection.hpp"
#include "octopair/engine.hpp"

namespace octopair::cli {

namespace {

/// A forward cursor over the pairs of a list.
class ListCursor {
public:
    explicit ListCursor(const PairList& list) : chunks_(list.chunks()) { skip_empty(); }
    bool at_end() const { return chunks_.empty(); }
    const Pair& operator*() const { return chunks_[0][at_]; }
    void next() {
        ++at_;
        skip_empty();
    }

private:
    void skip_empty() {
        while (!chunks_.empty() && at_ == chunks_[0].size()) {
            chunks_ = chunks_.subspan(1);
            at_ = 0;
        }
    }

    std::span<const std::span<const Pair>> chunks_;
    std::size_t at_ = 0;
};

/// The boxes of a set, in memory of the engine. read() replaces them by the boxes of another frame.
template <typename Real>
class FrameBoxes {
public:
    FrameBoxes(const FrameSet& set, std::span<const double> padding, Engine& engine)
        : set_(set), padding_(padding), boxes_(engine.allocate_boxes<Box<Real>>(set.objects())) {}

    void read(std::uint64_t frame, const std::stop_token& stop) {
        if (frame == 0 || set_.frames().moving) set_.read(frame, boxes_.boxes(), stop);
    }
    Objects objects() const { return {std::span<const Box<Real>>(boxes_.boxes()), padding_}; }

private:
    const FrameSet& set_;
    std::span<const double> padding_;
    BoxArray<Box<Real>> boxes_;
};

template <typename Real>
class EngineEvents final : public EventSource {
public:
    EngineEvents(const FrameSets& sets, const DetectRequest& request, std::unique_ptr<Engine> engine)
        : engine_(std::move(engine)), inputs_(sets.inputs, sets.paddings.inputs(), *engine_) {
        if (sets.against != nullptr) against_.emplace(*sets.against, sets.paddings.against(), *engine_);
        options_.margin = request.margin;
    }

    void read(std::uint64_t frame, const std::stop_token& stop) override {
        inputs_.read(frame, stop);
        if (against_) against_->read(frame, stop);
    }

    FrameEvents find(const std::stop_token& stop) override {
        std::swap(now_, before_);
        const Input input(inputs_.objects(), against_ ? std::optional(against_->objects()) : std::nullopt);
        engine_->find_pairs(input, now_, options_, stop);
        compare();
        return {ended_, began_, now_.size()};
    }

private:
    void compare() {
        ended_.clear();
        began_.clear();
        ListCursor before(before_), now(now_);
        while (!before.at_end() || !now.at_end()) {
            if (now.at_end() || (!before.at_end() && *before < *now)) {
                ended_.push_back(*before);
                before.next();
            } else if (before.at_end() || *now < *before) {
                began_.push_back(*now);
                now.next();
            } else {
                before.next();
                now.next();
            }
        }
    }

    std::unique_ptr<Engine> engine_;
    FrameBoxes<Real> inputs_;
    std::optional<FrameBoxes<Real>> against_;
    Options options_;
    PairList now_, before_;
    std::vector<Pair> ended_, began_;
};

}  // namespace

template <typename Real>
std::unique_ptr<EventSource> make_engine_events(const FrameSets& sets, const DetectRequest& request,
                                                std::unique_ptr<Engine> engine) {
    return std::make_unique<EngineEvents<Real>>(sets, request, std::move(engine));
}

template std::unique_ptr<EventSource> make_engine_events<float>(const FrameSets&, const DetectRequest&,
                                                                std::unique_ptr<Engine>);
template std::unique_ptr<EventSource> make_engine_events<double>(const FrameSets&, const DetectRequest&,
                                                                 std::unique_ptr<Engine>);

}  // namespace octopair::cli
