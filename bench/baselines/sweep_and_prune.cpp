// Sweep and prune on one axis (the paper's section 2.3.1).
#include <algorithm>
#include <numeric>

#include "baselines/baselines.hpp"
#include "baselines/overlap.hpp"

namespace octopair::baselines {

std::vector<Pair> sweep_and_prune(std::span<const Box3f> boxes, unsigned axis) {
    std::vector<std::uint32_t> order(boxes.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](auto i, auto j) { return boxes[i].min[axis] < boxes[j].min[axis]; });

    std::vector<Box3f> sorted;
    sorted.reserve(boxes.size());
    for (const std::uint32_t i : order) sorted.push_back(boxes[i]);

    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        for (std::size_t j = i + 1; j < sorted.size() && sorted[j].min[axis] <= sorted[i].max[axis]; ++j) {
            if (overlap(sorted[i], sorted[j])) pairs.push_back(ordered(order[i], order[j]));
        }
    }
    return pairs;
}

}  // namespace octopair::baselines
