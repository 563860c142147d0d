#include "boxes/origin_sample.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

namespace octopair {

std::array<double, 4> OriginSample::median(std::span<const Corner> corners) {
    std::array<double, 4> origin = {0, 0, 0, 0};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::vector<double> lows;
        for (const Corner& corner : corners) {
            if (std::abs(corner[axis]) <= DBL_MAX) lows.push_back(corner[axis]);
        }
        if (lows.empty()) continue;
        const auto middle = lows.begin() + std::ptrdiff_t(lows.size() / 2);
        std::nth_element(lows.begin(), middle, lows.end());
        origin[axis] = *middle;
    }
    return origin;
}

}  // namespace octopair
