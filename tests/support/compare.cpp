#include "support/compare.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>

namespace octopair::test {

namespace {

/// Prints a box in hexadecimal, so that the exact values can be copied into a test.
std::string describe(const Objects& objects, std::uint32_t index) {
    std::ostringstream text;
    text << std::hexfloat << index << " {";
    const auto write = [&](auto boxes) {
        for (const auto x : boxes[index].min) text << double(x) << ", ";
        text << "..";
        for (const auto x : boxes[index].max) text << ", " << double(x);
    };
    std::visit(write, objects.boxes);
    text << "}";
    if (!objects.padding.empty()) text << " padding " << objects.padding[index];
    return text.str();
}

std::vector<Pair> missing_from(const std::vector<Pair>& list, const std::vector<Pair>& of) {
    std::vector<Pair> missing;
    std::set_difference(of.begin(), of.end(), list.begin(), list.end(), std::back_inserter(missing));
    return missing;
}

}  // namespace

::testing::AssertionResult same_pairs(const std::vector<Pair>& found, const std::vector<Pair>& expected,
                                      const Searched& where) {
    if (found == expected) return ::testing::AssertionSuccess();
    auto failure = ::testing::AssertionFailure();
    failure << found.size() << " pairs, not " << expected.size();
    if (!std::is_sorted(found.begin(), found.end())) return failure << "; the pairs are not ascending";
    if (std::adjacent_find(found.begin(), found.end()) != found.end()) return failure << "; some pairs occur twice";
    const auto show = [&](const char* what, const std::vector<Pair>& pairs) {
        if (pairs.empty()) return;
        failure << "\n  " << what << ": " << pairs.size() << ", the first " << describe(where.first, pairs[0].a)
                << " with " << describe(where.second ? *where.second : where.first, pairs[0].b);
    };
    show("missing", missing_from(found, expected));
    show("unexpected", missing_from(expected, found));
    return failure;
}

::testing::AssertionResult same_bytes(const std::vector<Pair>& found, const std::vector<Pair>& expected) {
    if (found == expected) return ::testing::AssertionSuccess();
    const auto [a, b] = std::mismatch(found.begin(), found.end(), expected.begin(), expected.end());
    return ::testing::AssertionFailure() << found.size() << " pairs against " << expected.size()
                                         << "; they differ from " << a - found.begin() << " on";
}

}  // namespace octopair::test
