// AscendingBounds: the parameters of a pass that finds pairs in ascending order.
#pragma once

#include <cstdint>

namespace octopair {

/// Objects [begin, end).
struct ObjectRange {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
};

struct AscendingBounds {
    ObjectRange rows;                                 ///< range of `a`; pairs with another `a` are skipped
    std::uint64_t columns = 0;                        ///< upper bound on `b`: every b < columns
    std::uint64_t max_pairs = ~std::uint64_t(0) / 2;  ///< capacity of all pages together, in pairs
    std::uint64_t expected = 0;                       ///< expected number of pairs; 0: unknown
};

/// Thrown by a pass that needs more pages than `max_pairs` allows. At most a quarter of its pages are then partly filled.
struct OverBudget {};

}  // namespace octopair
