// Which fixed depth suits a scene.
#include <algorithm>
#include <bit>
#include <chrono>
#include <limits>

#include "baselines/baselines.hpp"

namespace octopair::baselines {

unsigned best_paper_level(std::span<const Box3f> boxes, PaperSettings settings, const std::stop_token& stop) {
    const unsigned middle = std::max(2u, unsigned(std::bit_width(boxes.size())) / 3);
    double least = std::numeric_limits<double>::infinity();
    unsigned best = middle;
    for (settings.level = middle - 1; settings.level <= middle + 1 && !stop.stop_requested(); ++settings.level) {
        const auto begin = std::chrono::steady_clock::now();
        (void)paper_pairs(boxes, settings);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (seconds < least) best = settings.level;
        least = std::min(least, seconds);
    }
    return best;
}

}  // namespace octopair::baselines
