// Poses: exact where arithmetic is, and else with bounds that hold the exact result.
#include "io/pose.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>

namespace octopair::test {
namespace {

using io::Pose;
using Rows = std::array<std::array<double, 4>, 3>;
using Integers = std::array<std::array<std::int64_t, 4>, 3>;

TEST(Pose, IdentityKeepsEveryBit) {
    const auto point = Pose().apply({0.1, -1e-310, 1e300});
    EXPECT_EQ(point.value, (std::array<double, 3>{0.1, -1e-310, 1e300}));
    EXPECT_EQ(point.low, point.value);
    EXPECT_EQ(point.high, point.value);
}

TEST(Pose, ExactArithmeticStaysExact) {
    const Pose move({{{1, 0, 0, 5}, {0, 1, 0, -7}, {0, 0, 1, 0.5}}});
    const Pose mirror({{{-2, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}}});
    const auto point = (move * mirror).apply({1.5, 2, 3});
    EXPECT_EQ(point.low, (std::array<double, 3>{2, -4, 2.5}));
    EXPECT_EQ(point.high, point.low);
}

TEST(Pose, InexactArithmeticIsBounded) {
    const Pose turn({{{0.6, -0.8, 0, 0.1}, {0.8, 0.6, 0, 0.1}, {0, 0, 1, 0.1}}});
    const auto point = turn.apply({0.1, 0.2, 0.3});
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LT(point.low[axis], point.value[axis]);
        EXPECT_GT(point.high[axis], point.value[axis]);
        EXPECT_NEAR(point.low[axis], point.high[axis], 1e-15);
    }
}

rc::Gen<Integers> integer_rows(std::int64_t most) {
    using Row = std::array<std::int64_t, 4>;
    return rc::gen::container<Integers>(rc::gen::container<Row>(rc::gen::inRange<std::int64_t>(-most, most)));
}

Rows as_rows(const Integers& integers, int exponent) {
    Rows rows;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 4; ++c) rows[r][c] = std::ldexp(double(integers[r][c]), exponent);
    }
    return rows;
}

// Numbers of 30 bits, so that exact results have some 95: far more than float64 holds.
RC_GTEST_PROP(Pose, BoundsHoldTheExactResult, ()) {
    __extension__ using Wide = __int128;
    const std::int64_t most = std::int64_t(1) << 30;
    const auto a = *rc::gen::resize(1 << 20, integer_rows(most)), b = *rc::gen::resize(1 << 20, integer_rows(most));
    const auto v =
        *rc::gen::container<std::array<std::int64_t, 3>>(rc::gen::resize(1 << 20, rc::gen::inRange(-most, most)));
    const auto point =
        (Pose(as_rows(a, -30)) * Pose(as_rows(b, -30)))
            .apply({std::ldexp(double(v[0]), -30), std::ldexp(double(v[1]), -30), std::ldexp(double(v[2]), -30)});
    for (int row = 0; row < 3; ++row) {
        // In units of 2^-90.
        Wide exact = Wide(a[row][3]) << 60;
        for (int k = 0; k < 3; ++k) {
            Wide inner = Wide(b[k][3]) << 30;
            for (int j = 0; j < 3; ++j) inner += Wide(b[k][j]) * v[j];
            exact += inner * a[row][k];
        }
        RC_ASSERT(Wide(std::floor(std::ldexp(point.low[row], 90))) <= exact);
        RC_ASSERT(Wide(std::ceil(std::ldexp(point.high[row], 90))) >= exact);
        RC_ASSERT(point.high[row] - point.low[row] < 1e-13);
    }
}

}  // namespace
}  // namespace octopair::test
