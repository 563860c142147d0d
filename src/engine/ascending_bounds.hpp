// What is asked of a pass that finds pairs in ascending order.
#pragma once

#include <cstdint>

namespace octopair {

/// Objects [begin, end).
struct ObjectRange {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
};

struct AscendingBounds {
    ObjectRange rows;                            ///< the `a` that are wanted
    std::uint64_t columns = 0;                   ///< above every `b`
    std::uint64_t most = ~std::uint64_t(0) / 2;  ///< pairs for whom there may be pages
    std::uint64_t expected = 0;                  ///< pairs, if that is known
};

/// Thrown by a pass that needs more pages than `most` allows; no more than a quarter of them is not full.
struct OverBudget {};

}  // namespace octopair
