// Search for the fixed depth at which the paper's algorithm is fastest on a scene.
#include <algorithm>
#include <bit>
#include <chrono>
#include <limits>
#include <new>

#include "baselines/baselines.hpp"
#include "octopair/octal_code.hpp"

namespace octopair::baselines {

namespace {

/// Returns the run time, or infinity if the octants do not fit into the memory.
double seconds_at(unsigned level, std::span<const Box3f> boxes, PaperSettings settings) {
    settings.level = level;
    const auto begin = std::chrono::steady_clock::now();
    try {
        (void)paper_pairs(boxes, settings);
    } catch (const std::bad_alloc&) {
        return std::numeric_limits<double>::infinity();
    }
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

unsigned best_paper_level(std::span<const Box3f> boxes, const PaperSettings& settings, const std::stop_token& stop) {
    unsigned best = std::max(2u, unsigned(std::bit_width(boxes.size())) / 3);
    double least = seconds_at(best, boxes, settings);
    const auto improves = [&](unsigned level) {
        if (stop.stop_requested()) return false;
        const double seconds = seconds_at(level, boxes, settings);
        if (seconds >= least) return false;
        least = seconds;
        best = level;
        return true;
    };
    const unsigned usual = best;
    while (best < OctalCode::max_level && improves(best + 1)) {
    }
    while (best <= usual && best > 1 && improves(best - 1)) {
    }
    return best;
}

}  // namespace octopair::baselines
