// Tests octal codes against the examples of the paper and against plain vectors of digits.
#include "octopair/octal_code.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include "octopair/error.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

using Digits = std::vector<std::uint8_t>;

rc::Gen<Digits> any_digits() {
    return rc::gen::mapcat(rc::gen::inRange<std::size_t>(0, OctalCode::max_level + 1), [](std::size_t level) {
        return rc::gen::container<Digits>(level, rc::gen::inRange<std::uint8_t>(0, 8));
    });
}

/// Generates two paths with a common prefix, more often than random paths have.
rc::Gen<std::pair<Digits, Digits>> related_digits() {
    return rc::gen::apply(
        [](Digits a, const Digits& b, std::size_t common) {
            common = std::min({common, a.size(), b.size()});
            std::copy(b.begin(), b.begin() + std::ptrdiff_t(common), a.begin());
            return std::pair(a, b);
        },
        any_digits(), any_digits(), rc::gen::inRange<std::size_t>(0, OctalCode::max_level + 1));
}

bool is_prefix(const Digits& a, const Digits& b) {
    return a.size() <= b.size() && std::equal(a.begin(), a.end(), b.begin());
}

TEST(OctalCodePaper, FigureFourIsVisitedInItsOrder) {
    const std::vector<std::uint64_t> visited = {1000, 2000, 2200, 2210, 2230, 2542, 2546, 2600, 5000};
    std::vector<OctalCode> codes;
    for (const std::uint64_t integer : visited) codes.push_back(OctalCode::from_integer(integer));
    std::mt19937 random(4);
    for (int i = 0; i < 20; ++i) {
        std::shuffle(codes.begin(), codes.end(), random);
        std::sort(codes.begin(), codes.end());
        std::vector<std::uint64_t> order;
        for (const OctalCode code : codes) order.push_back(code.integer(4));
        EXPECT_EQ(order, visited);
    }
}

TEST(OctalCodePaper, SequenceAndInteger) {
    const OctalCode code = OctalCode::from_text("{3, 1, 4}");
    EXPECT_EQ(code.integer(), 314u);
    EXPECT_EQ(code, OctalCode::from_integer(314));
    EXPECT_EQ(code.level(), 3u);
    EXPECT_EQ(code, OctalCode().child(2).child(0).child(3));
    EXPECT_EQ(code.text(), "{3,1,4}");
}

TEST(OctalCodePaper, CommonPathComparesUpToTheShorter) {
    const OctalCode deep = OctalCode::from_text("{1,2,3,4,5}"), shallow = OctalCode::from_text("{1,2,6,0,0}");
    EXPECT_EQ(shallow.level(), 3u);
    EXPECT_FALSE(common_path(deep, shallow));
    EXPECT_TRUE(common_path(deep, OctalCode::from_text("{1,2,3,0,0}")));
}

TEST(OctalCodePaper, TruncatedIntegersAreCompared) {
    const OctalCode deep = OctalCode::from_integer(12345), shallow = OctalCode::from_integer(12600);
    EXPECT_EQ(deep.ancestor(shallow.level()).integer(5), 12300u);
    EXPECT_NE(deep.ancestor(shallow.level()), shallow);
}

TEST(OctalCodePaper, SequenceOfOverlappingOctants) {
    const OctalCode parent = OctalCode::from_integer(1200), child = OctalCode::from_integer(1210);
    const OctalCode grandchild = OctalCode::from_integer(1214), other = OctalCode::from_integer(1330);
    EXPECT_LT(parent, child);
    EXPECT_LT(child, grandchild);
    EXPECT_LT(grandchild, other);
    EXPECT_TRUE(common_path(parent, child) && common_path(parent, grandchild) && common_path(child, grandchild));
    EXPECT_EQ(child.parent(), parent);
    EXPECT_EQ(grandchild.parent(), child);
    for (const OctalCode code : {parent, child, grandchild}) EXPECT_FALSE(common_path(code, other));
}

TEST(OctalCode, RootHoldsAllAndIsItsOwnParent) {
    const OctalCode root;
    EXPECT_EQ(root.level(), 0u);
    EXPECT_EQ(root.text(), "{}");
    EXPECT_EQ(root, OctalCode::from_text("{}"));
    EXPECT_EQ(root, OctalCode::from_integer(0));
    EXPECT_EQ(root.integer(), 0u);
    EXPECT_EQ(root.parent(), root);
    EXPECT_TRUE(root.contains(OctalCode::from_integer(12345)));
    EXPECT_FALSE(OctalCode::from_integer(1).contains(root));
}

TEST(OctalCode, DigitBitsAreTheAxes) {
    constexpr std::uint32_t high = 1u << (OctalCode::max_level - 1);
    EXPECT_EQ(OctalCode::from_cell({high, 0, 0}, 1), OctalCode().child(1));
    EXPECT_EQ(OctalCode::from_cell({0, high, 0}, 1), OctalCode().child(2));
    EXPECT_EQ(OctalCode::from_cell({0, 0, high}, 1), OctalCode().child(4));
    EXPECT_EQ(OctalCode::from_cell({1, 0, 1}, OctalCode::max_level).digit(OctalCode::max_level - 1), 5u);
}

TEST(OctalCode, TextIsRefused) {
    for (const char* text :
         {"", "{", "}", "1", "{1", "1}", "{1,}", "{,1}", "{1 2}", "{9}", "{-1}", "{1,0,2}", "{a}", "{1}x", "{1,,2}",
          "{0x1}", "{4294967297}", "{99999999999999999999}", "{1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1}"}) {
        EXPECT_EQ(code_of([&] { OctalCode::from_text(text); }), ErrorCode::bad_input) << text;
    }
}

TEST(OctalCode, IntegersAreRefused) {
    for (const std::uint64_t integer : {9ull, 19ull, 101ull, 1002003ull, 18446744073709551615ull}) {
        EXPECT_EQ(code_of([&] { OctalCode::from_integer(integer); }), ErrorCode::bad_input) << integer;
    }
    const OctalCode code = OctalCode::from_integer(314);
    EXPECT_EQ(code_of([&] { (void)code.integer(2); }), ErrorCode::bad_input);
    EXPECT_EQ(code_of([&] { (void)code.integer(20); }), ErrorCode::bad_input);
    EXPECT_EQ(code.integer(19), 3140000000000000000u);
    EXPECT_EQ(code_of([] { (void)OctalCode::from_digits(Digits(20, 7)).integer(); }), ErrorCode::bad_input);
}

TEST(OctalCode, DigitsAreRefused) {
    EXPECT_EQ(code_of([] { OctalCode::from_digits(Digits{1, 8}); }), ErrorCode::bad_input);
    EXPECT_EQ(code_of([] { OctalCode::from_digits(Digits(22, 0)); }), ErrorCode::bad_input);
    EXPECT_EQ(code_of([] { OctalCode::from_digits(Digits(21, 0)); }), std::nullopt);
}

RC_GTEST_PROP(OctalCodeProperty, DigitsRoundTrip, ()) {
    const Digits digits = *any_digits();
    const OctalCode code = OctalCode::from_digits(digits);
    RC_ASSERT(code.level() == digits.size());
    for (unsigned i = 0; i < digits.size(); ++i) RC_ASSERT(code.digit(i) == digits[i]);
}

RC_GTEST_PROP(OctalCodeProperty, TextAndIntegerRoundTrip, ()) {
    const OctalCode code = OctalCode::from_digits(*any_digits());
    RC_ASSERT(OctalCode::from_text(code.text()) == code);
    if (code.level() > 19) return;
    RC_ASSERT(OctalCode::from_integer(code.integer()) == code);
    RC_ASSERT(OctalCode::from_integer(code.integer(19)) == code);
}

RC_GTEST_PROP(OctalCodeProperty, OrderIsThatOfDigitsWhichIsPreOrder, ()) {
    const auto [a, b] = *related_digits();
    const OctalCode code_a = OctalCode::from_digits(a), code_b = OctalCode::from_digits(b);
    RC_ASSERT((code_a < code_b) == (a < b));
    RC_ASSERT((code_a == code_b) == (a == b));
}

RC_GTEST_PROP(OctalCodeProperty, OrderIsThatOfPaddedIntegers, ()) {
    const auto [a, b] = *related_digits();
    RC_PRE(a.size() <= 19 && b.size() <= 19);
    const OctalCode code_a = OctalCode::from_digits(a), code_b = OctalCode::from_digits(b);
    RC_ASSERT((code_a < code_b) == (code_a.integer(19) < code_b.integer(19)));
}

RC_GTEST_PROP(OctalCodeProperty, ContainsIsPrefix, ()) {
    const auto [a, b] = *related_digits();
    const OctalCode code_a = OctalCode::from_digits(a), code_b = OctalCode::from_digits(b);
    RC_ASSERT(code_a.contains(code_b) == is_prefix(a, b));
    RC_ASSERT(common_path(code_a, code_b) == (is_prefix(a, b) || is_prefix(b, a)));
}

RC_GTEST_PROP(OctalCodeProperty, AncestorsAreTheFirstDigits, ()) {
    const Digits digits = *any_digits();
    const OctalCode code = OctalCode::from_digits(digits);
    for (unsigned level = 0; level <= digits.size(); ++level) {
        const OctalCode ancestor = code.ancestor(level);
        RC_ASSERT(ancestor == OctalCode::from_digits(std::span(digits).first(level)));
        RC_ASSERT(ancestor <= code);
        if (level < digits.size()) RC_ASSERT(ancestor.child(digits[level]) == code.ancestor(level + 1));
        if (level > 0) RC_ASSERT(ancestor.parent() == code.ancestor(level - 1));
    }
}

RC_GTEST_PROP(OctalCodeProperty, WhatAnOctantHoldsFollowsItInARun, ()) {
    auto paths = *rc::gen::container<std::vector<Digits>>(any_digits());
    for (Digits& path : paths) path.resize(std::min<std::size_t>(path.size(), 3));
    std::vector<OctalCode> codes;
    for (const Digits& path : paths) codes.push_back(OctalCode::from_digits(path));
    std::sort(codes.begin(), codes.end());
    for (std::size_t i = 0; i < codes.size(); ++i) {
        bool inside = true;
        for (std::size_t j = i; j < codes.size(); ++j) {
            if (!codes[i].contains(codes[j])) inside = false;
            RC_ASSERT(codes[i].contains(codes[j]) == inside);
        }
    }
}

RC_GTEST_PROP(OctalCodeProperty, CellsInterleave, (std::uint32_t x, std::uint32_t y, std::uint32_t z)) {
    constexpr std::uint32_t mask = (1u << OctalCode::max_level) - 1;
    const auto level = *rc::gen::inRange(0u, OctalCode::max_level + 1);
    const OctalCode code = OctalCode::from_cell({x & mask, y & mask, z & mask}, level);
    RC_ASSERT(code.level() == level);
    for (unsigned i = 0; i < level; ++i) {
        const unsigned bit = OctalCode::max_level - 1 - i;
        RC_ASSERT(code.digit(i) == ((x >> bit & 1u) | (y >> bit & 1u) << 1 | (z >> bit & 1u) << 2));
    }
}

}  // namespace
}  // namespace octopair::test
