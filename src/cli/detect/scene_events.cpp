// Scene events: a Scene, local or on a server, finds the events. For each frame, the scene gets only the boxes that have changed.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "cli/detect/event_detection.hpp"
#include "cli/server/server_choice.hpp"
#include "octopair/remote_scene.hpp"
#include "octopair/scene.hpp"

namespace octopair::cli {

namespace {

/// The objects of one set in a scene, with their boxes in this frame and in the frame before.
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

    template <typename AnyScene>
    void add(AnyScene& scene, std::span<const double> padding, std::span<const Traits> traits) {
        scene.add({std::span<const Box<Real>>(now_.span()), padding}, ids_, traits);
    }

    /// Moves the objects whose boxes differ from the frame before. Each run of consecutive objects is one call.
    template <typename AnyScene>
    void move(AnyScene& scene) const {
        if (!set_.frames().moving) return;
        for (std::size_t begin = 0; begin < ids_.size(); ++begin) {
            std::size_t end = begin;
            while (end < ids_.size() && differs(end)) ++end;
            if (end == begin) continue;
            scene.move(std::span(ids_).subspan(begin, end - begin), now_.span().subspan(begin, end - begin));
            begin = end;  // box `end` has not changed, so the loop's increment may skip it
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

/// Finds events with a scene. A new scene numbers objects in the order of addition: first the inputs, then the second set.
template <typename Real, typename AnyScene>
class SceneEvents final : public EventSource {
public:
    SceneEvents(const FrameSets& sets, AnyScene scene)
        : paddings_(sets.paddings), inputs_(sets.inputs), first_(sets.inputs.objects()), scene_(std::move(scene)) {
        if (sets.against != nullptr) against_.emplace(*sets.against);
    }

    void read(std::uint64_t frame, const std::stop_token& stop) override {
        inputs_.read(frame, stop);
        if (against_) against_->read(frame, stop);
    }

    FrameEvents find(const std::stop_token& stop) override {
        std::exchange(added_, true) ? move() : add();
        const StepResult& step = scene_.step(stop);
        return {in_own_set(step.ended, ended_), in_own_set(step.began, began_), step.pairs()};
    }

private:
    void add() {
        if (!against_) return inputs_.add(scene_, paddings_.inputs(), {});
        // These groups and masks permit only pairs of an object of the inputs with an object of the second set.
        inputs_.add(scene_, paddings_.inputs(), std::array{Traits{.groups = 1, .mask = 2}});
        against_->add(scene_, paddings_.against(), std::array{Traits{.groups = 2, .mask = 1}});
    }

    void move() {
        inputs_.move(scene_);
        if (against_) against_->move(scene_);
    }

    std::span<const Pair> in_own_set(std::span<const Pair> pairs, std::vector<Pair>& renumbered) const {
        if (!against_) return pairs;
        renumbered.clear();
        for (const auto [a, b] : pairs) renumbered.push_back({a, b - std::uint32_t(first_)});
        return renumbered;
    }

    const Paddings& paddings_;
    MovingObjects<Real> inputs_;
    std::optional<MovingObjects<Real>> against_;
    std::uint64_t first_;  // number of the second set's first object in the scene
    AnyScene scene_;
    bool added_ = false;
    std::vector<Pair> ended_, began_;
};

}  // namespace

template <typename Real>
std::unique_ptr<EventSource> make_scene_events(const FrameSets& sets, const DetectRequest& request) {
    constexpr Precision precision = sizeof(Real) == sizeof(float) ? Precision::float32 : Precision::float64;
#ifdef OCTOPAIR_WITH_SERVICE
    if (request.engine.is_server()) {
        return std::make_unique<SceneEvents<Real, RemoteScene>>(
            sets, connect_scene(request.engine.server.address, {precision, request.margin},
                                client_options(request.engine.server)));
    }
#endif
    const SceneOptions options{request.engine.threads.value_or(0), precision, request.margin};
    return std::make_unique<SceneEvents<Real, Scene>>(sets, Scene(options));
}

template std::unique_ptr<EventSource> make_scene_events<float>(const FrameSets&, const DetectRequest&);
template std::unique_ptr<EventSource> make_scene_events<double>(const FrameSets&, const DetectRequest&);

}  // namespace octopair::cli
