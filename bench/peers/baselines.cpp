// The project's own baselines (baselines/baselines.hpp).
#include "baselines/baselines.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <limits>

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
        if (settings_.level == 0) settings_.level = best_level(boxes);
        pairs_ = baselines::paper_pairs(boxes, settings_).pairs;
    }

private:
    unsigned best_level(std::span<const Box3f> boxes) {
        const unsigned middle = std::max(2u, unsigned(std::bit_width(boxes.size())) / 3);
        double least = std::numeric_limits<double>::infinity();
        unsigned best = middle;
        for (unsigned level = middle - 1; level <= middle + 1; ++level) {
            baselines::PaperSettings settings = settings_;
            settings.level = level;
            const auto begin = std::chrono::steady_clock::now();
            (void)baselines::paper_pairs(boxes, settings);
            const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
            if (seconds < least) best = level;
            least = std::min(least, seconds);
        }
        return best;
    }

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
