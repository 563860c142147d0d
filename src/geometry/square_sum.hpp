// Square sums: comparisons of sums of squared differences of float64, without error. Slow; for what rounding leaves open.
#pragma once

#include <array>

namespace octopair {

/// high - low as a real number. Requires: finite, high >= low.
struct Gap {
    double high = 0;
    double low = 0;
};
using Gaps = std::array<Gap, 3>;

/// Returns -1, 0 or 1: how the sum of the squares of `a` compares with that of `b`.
int compare_square_sums(const Gaps& a, const Gaps& b);

/// Returns -1, 0 or 1: how the root of the sum of the squares of `gaps` compares with the middle between `low` and the next
/// float64 above, which is 2^1024 after the largest. Requires: low finite, >= 0.
int compare_root_with_middle(const Gaps& gaps, double low);

}  // namespace octopair
