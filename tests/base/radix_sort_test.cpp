// Tests RadixSort against std::stable_sort, for both key types and for sizes on both sides of its threshold.
#include "base/radix_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace octopair::test {
namespace {

template <typename Key>
class RadixSortOf : public ::testing::Test {};
using Keys = ::testing::Types<std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(RadixSortOf, Keys);

TYPED_TEST(RadixSortOf, SortsByTheLowBits) {
    std::mt19937_64 random(3);
    RadixSort<TypeParam> radix;
    for (const std::size_t size : {0u, 1u, 2u, 100u, 5'000u, 100'000u}) {
        for (const unsigned bits : {1u, 11u, 12u, 30u, unsigned(8 * sizeof(TypeParam))}) {
            const TypeParam mask = TypeParam(~TypeParam(0)) >> (8 * sizeof(TypeParam) - bits);
            std::vector<TypeParam> expected(size);
            for (TypeParam& key : expected) key = TypeParam(random()) & mask;
            std::ranges::copy(expected, radix.take(size).begin());
            std::ranges::sort(expected);
            const auto sorted = radix.sort(0, bits);
            ASSERT_TRUE(std::ranges::equal(sorted, expected)) << size << " keys of " << bits << " bits";
        }
    }
}

TYPED_TEST(RadixSortOf, SkipsBitsThatAreInOrder) {
    constexpr std::size_t size = 50'000;
    std::mt19937_64 random(4);
    std::vector<TypeParam> expected(size);
    // The keys are in order of their low 8 bits, which sort() skips.
    for (std::size_t i = 0; i < size; ++i) expected[i] = TypeParam((random() & 0xFFFF) << 8 | i * 256 / size);
    RadixSort<TypeParam> radix;
    std::ranges::copy(expected, radix.take(size).begin());
    std::ranges::sort(expected);
    EXPECT_TRUE(std::ranges::equal(radix.sort(8, 24), expected));
}

}  // namespace
}  // namespace octopair::test
