// Comparison of pair lists that says which pair differs, with its boxes.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "octopair/octopair.hpp"

namespace octopair::testing {

/// What a list of pairs was found in; `second` is null but for a join.
struct Searched {
    const Objects& first;
    const Objects* second = nullptr;
};

/// Success if both lists are the same, pair for pair; else the number of differences and the first pair that is missing
/// or one too many. Both are ascending.
::testing::AssertionResult same_pairs(const std::vector<Pair>& found, const std::vector<Pair>& expected,
                                      const Searched& where);

/// Success if both are the same, in the same order.
::testing::AssertionResult same_bytes(const std::vector<Pair>& found, const std::vector<Pair>& expected);

}  // namespace octopair::testing
