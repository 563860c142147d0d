// Contenders for the project's own baselines (baselines/baselines.hpp).
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

/// Paper's algorithm at its best fixed depth for the scene.
class Paper : public CollectingContender {
public:
    explicit Paper(unsigned threads) { settings_.slaves_per_machine = threads; }

    void prepare(std::span<const Box3f> boxes) override {
        settings_.level = baselines::best_paper_level(boxes, settings_);
    }
    void run(std::span<const Box3f> boxes) override { pairs_ = baselines::paper_pairs(boxes, settings_).pairs; }

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
         [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<SweepAndPrune>(); }, 200'000},
    };
}

}  // namespace octopair::bench
