// octopair as contender and tracker. The timed call is find_pairs in octal order into a reused list; variants sort in
// ascending order or count. Frame by frame: scenes, and full detection of every frame.
#include "octopair/octopair.hpp"

#include <algorithm>

#include "peers/contender.hpp"
#include "peers/tracker.hpp"

namespace octopair::bench {

namespace {

class Ours : public Contender {
public:
    Ours(unsigned threads, Order order) : engine_(make_local_engine(threads)) { options_.order = order; }

    void run(std::span<const Box3f> boxes) override { find(Objects{boxes}); }
    Found found() const override {
        Found found;
        for (const auto chunk : pairs_.chunks()) add(found, chunk);
        return found;
    }

protected:
    void find(const Objects& objects) { (void)engine_->find_pairs(objects, pairs_, options_); }

private:
    std::unique_ptr<Engine> engine_;
    Options options_;
    PairList pairs_;
};

/// Counts pairs without a list, so there is no hash to compare.
class OursCounting : public Contender {
public:
    explicit OursCounting(unsigned threads) : engine_(make_local_engine(threads)) {}
    void run(std::span<const Box3f> boxes) override { pairs_ = engine_->count_pairs(Objects{boxes}); }
    Found found() const override { return {pairs_, 0}; }

private:
    std::unique_ptr<Engine> engine_;
    std::uint64_t pairs_ = 0;
};

/// Converts boxes to float64.
void widen(std::span<const Box3f> boxes, std::vector<Box3d>& wide) {
    wide.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        std::copy_n(boxes[i].min, 3, wide[i].min);
        std::copy_n(boxes[i].max, 3, wide[i].max);
    }
}

/// Uses equal boxes in float64, converted on the first run.
class OursWide : public Ours {
public:
    explicit OursWide(unsigned threads) : Ours(threads, Order::octal) {}
    void run(std::span<const Box3f> boxes) override {
        if (narrow_.data() != boxes.data() || narrow_.size() != boxes.size()) {
            narrow_ = boxes;
            widen(boxes, wide_);
        }
        find(Objects{std::span<const Box3d>(wide_)});
    }

private:
    std::span<const Box3f> narrow_;
    std::vector<Box3d> wide_;
};

/// Calls move() and step(), which report pairs that began and ended. Builds no full list, so there is no hash to
/// compare.
class SceneSteps : public Tracker {
public:
    explicit SceneSteps(unsigned threads) : scene_({.threads = threads}) {}
    void begin(std::span<const Box3f> boxes) override {
        ids_.resize(boxes.size());
        scene_.add(Objects{boxes}, ids_);
        pairs_ = scene_.step().pairs();
    }
    void next(const Frame& frame) override {
        moved_.clear();
        for (const std::uint32_t object : frame.moved) moved_.push_back(ids_[object]);
        scene_.move(moved_, frame.moved_boxes);
        pairs_ = scene_.step().pairs();
    }
    Found found() const override { return {pairs_, 0}; }
    std::optional<std::uint64_t> overlaps(std::span<const Box3f> boxes) override {
        widen(boxes, wide_);
        scene_.overlaps(wide_, answers_);
        return answers_.all.size();
    }

protected:
    octopair::Scene scene_;

private:
    std::vector<ObjectId> ids_, moved_;
    std::vector<Box3d> wide_;
    Answers<std::uint32_t> answers_;
    std::uint64_t pairs_ = 0;
};

/// Also calls pairs(), which returns the whole list.
class ScenePairs : public SceneSteps {
public:
    using SceneSteps::SceneSteps;
    void begin(std::span<const Box3f> boxes) override {
        SceneSteps::begin(boxes);
        list_ = &scene_.pairs();
    }
    void next(const Frame& frame) override {
        SceneSteps::next(frame);
        list_ = &scene_.pairs();
    }
    Found found() const override {
        Found found;
        for (const auto chunk : list_->chunks()) add(found, chunk);
        return found;
    }

private:
    const PairList* list_ = nullptr;
};

/// Runs a full detection in every frame.
class FullDetection : public Tracker {
public:
    explicit FullDetection(unsigned threads) : ours_(threads, Order::ascending) {}
    void begin(std::span<const Box3f> boxes) override { ours_.run(boxes); }
    void next(const Frame& frame) override { ours_.run(frame.boxes); }
    Found found() const override { return ours_.found(); }

private:
    Ours ours_;
};

}  // namespace

std::vector<ContenderKind> octopair_contenders() {
    return {
        {"octopair", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Ours>(k, Order::octal); }},
        {"octopair ascending", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Ours>(k, Order::ascending); }},
        {"octopair count", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<OursCounting>(k); }},
        {"octopair float64", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<OursWide>(k); }},
    };
}

std::vector<TrackerKind> octopair_trackers() {
    return {
        {"full detection", true,
         [](unsigned k) -> std::unique_ptr<Tracker> { return std::make_unique<FullDetection>(k); }},
        {"scene", true, [](unsigned k) -> std::unique_ptr<Tracker> { return std::make_unique<ScenePairs>(k); }},
        {"scene, changes only", true,
         [](unsigned k) -> std::unique_ptr<Tracker> { return std::make_unique<SceneSteps>(k); }},
    };
}

}  // namespace octopair::bench
