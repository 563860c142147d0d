// The project's own baselines (baselines/baselines.hpp).
#include "baselines/baselines.hpp"

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

class Lbvh : public CollectingContender {
public:
    explicit Lbvh(unsigned threads) : threads_(threads) {}
    void run(std::span<const Box3f> boxes) override { pairs_ = baselines::lbvh_pairs(boxes, threads_); }

private:
    unsigned threads_;
};

/// At its best fixed depth for the scene, found on the first run by trying those about one octant an object.
class Paper : public CollectingContender {
public:
    explicit Paper(unsigned threads) { settings_.slaves_per_machine = threads; }

    void run(std::span<const Box3f> boxes) override {
        if (settings_.level == 0) settings_.level = baselines::best_paper_level(boxes, settings_);
        pairs_ = baselines::paper_pairs(boxes, settings_).pairs;
    }

private:
    baselines::PaperSettings settings_;
};

class SweepAndPrune : public CollectingContender {
public:
    void run(std::span<const Box3f> boxes) override { pairs_ = baselines::sweep_and_prune(boxes); }
};

}  // namespace

std::vector<ContenderKind> baseline_contenders() {
    return {
        {"LBVH", true, false, [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Lbvh>(k); }},
        {"paper", true, false, [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Paper>(k); }},
        {"sweep and prune", false, false,
         [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<SweepAndPrune>(); }},
    };
}

}  // namespace octopair::bench
