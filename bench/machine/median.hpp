// The median of measurements.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace octopair::bench {

/// Returns the median: of an even number of values the greater of the two in the middle; 0 if there are no values.
inline double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace octopair::bench
