// Tests outward rounding against exact integers and at the ends of the range of float32.
#include "geometry/rounding.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>

namespace octopair::test {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

TEST(Rounding, FloatAboveIsTheSmallestThatIsNotBelow) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 100'000; ++i) {
        const auto value = std::bit_cast<double>(random());
        if (std::isnan(value)) continue;
        const float above = rounding::float_above(value);
        ASSERT_GE(double(above), value);
        if (std::isfinite(above)) {
            ASSERT_LT(double(std::nextafter(above, -infinity)), value);
        }
    }
}

TEST(Rounding, FloatAboveAtTheEnds) {
    EXPECT_EQ(rounding::float_above(double(FLT_MAX)), FLT_MAX);
    EXPECT_EQ(rounding::float_above(std::nextafter(double(FLT_MAX), 1e300)), infinity);
    EXPECT_EQ(rounding::float_above(1e-320), std::numeric_limits<float>::denorm_min());
    EXPECT_EQ(rounding::float_above(-1e-320), 0.0F);
}

TEST(Rounding, FiniteFloatAboveIsFiniteAndNearestZerosArePositive) {
    EXPECT_EQ(rounding::finite_float_above(1e300), FLT_MAX);
    EXPECT_EQ(rounding::finite_float_above(-1e300), -FLT_MAX);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(rounding::finite_float_above(-1e-320)), 0u);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(rounding::finite_float_above(-0.0)), 0u);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(rounding::finite_float_above(-1e-45)), 0u);
    EXPECT_EQ(rounding::finite_float_above(0.1), rounding::float_above(0.1));
}

// Sums of integers whose sizes differ by up to 60 bits. The sums are exact in 128 bits, and mostly inexact in float64.
TEST(Rounding, SumAboveIsTheSmallestThatIsNotBelow) {
    __extension__ using Int128 = __int128;
    std::mt19937_64 random(2);
    for (int i = 0; i < 100'000; ++i) {
        const auto draw = [&] { return double(std::int64_t(random()) >> (random() % 60)); };
        const double a = draw(), b = draw();
        const Int128 exact = Int128(a) + Int128(b);
        const double above = rounding::sum_above(a, b);
        ASSERT_GE(Int128(above), exact) << a << " + " << b;
        ASSERT_LT(Int128(rounding::next_below(above)), exact + (std::abs(above) < 0x1p53 ? 1 : 0)) << a << " + " << b;
    }
}

}  // namespace
}  // namespace octopair::test
