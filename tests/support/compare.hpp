// Comparisons of sequences and lists of pairs that report the first difference.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <ostream>
#include <vector>

#include "octopair/octopair.hpp"

namespace octopair {

/// Prints a pair for GoogleTest, which looks for this function in the namespace of Pair.
inline void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.a << "-" << pair.b; }

}  // namespace octopair

namespace octopair::test {

/// Succeeds if both sequences are equal. Otherwise reports their sizes and the first elements that differ.
template <typename Sequence>
::testing::AssertionResult same_sequence(const Sequence& found, const Sequence& expected) {
    if (found == expected) return ::testing::AssertionSuccess();
    const auto [a, b] = std::ranges::mismatch(found, expected);
    auto failure = ::testing::AssertionFailure();
    failure << std::size(found) << " elements, not " << std::size(expected) << "; from element "
            << std::distance(std::begin(found), a) << " on they differ";
    if (a != std::end(found)) failure << ", found " << ::testing::PrintToString(*a);
    if (b != std::end(expected)) failure << ", expected " << ::testing::PrintToString(*b);
    return failure;
}

/// The objects of a search. `second` is null except for a join.
struct Searched {
    const Objects& first;
    const Objects* second = nullptr;
};

/// Succeeds if both lists hold the same pairs. Otherwise reports the numbers of missing and unexpected pairs, and the
/// first of each. Fails if `found` is not ascending or has a pair twice. Requires: `expected` is ascending.
::testing::AssertionResult same_pairs(const std::vector<Pair>& found, const std::vector<Pair>& expected,
                                      const Searched& where);

/// Succeeds if both lists hold the same pairs in the same order.
::testing::AssertionResult same_bytes(const std::vector<Pair>& found, const std::vector<Pair>& expected);

}  // namespace octopair::test
