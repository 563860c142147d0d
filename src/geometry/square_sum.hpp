// Square sums: exact comparisons of sums of squared differences of float64 numbers. Slow; used where float64 rounding leaves
// the result open.
#pragma once

#include <array>

namespace octopair {

/// The real number high - low. Requires: both are finite; high >= low.
struct Gap {
    double high = 0;
    double low = 0;
};
using Gaps = std::array<Gap, 3>;

/// Returns -1, 0 or 1 if the sum of the squares of `a` is less than, equal to or greater than that of `b`.
int compare_square_sums(const Gaps& a, const Gaps& b);

/// Compares the root of the sum of the squares of `gaps` with the middle between `low` and the next larger float64. The
/// successor of the largest float64 counts as 2^1024. Returns -1, 0 or 1 if the root is less than, equal to or greater than the
/// middle.
/// Requires: `low` is finite and >= 0.
int compare_root_with_middle(const Gaps& gaps, double low);

}  // namespace octopair
