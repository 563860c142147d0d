// Tests poses with error bounds: exact where the arithmetic is exact, otherwise the bounds contain the exact result.
#include "io/meshes/bounded_pose.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>

namespace octopair::test {
namespace {

using Rows = std::array<std::array<double, 4>, 3>;
using Integers = std::array<std::array<std::int64_t, 4>, 3>;

TEST(BoundedPose, IdentityKeepsEveryBit) {
    const auto point = BoundedPose().apply({0.1, -1e-310, 1e300});
    EXPECT_EQ(point.value, (std::array<double, 3>{0.1, -1e-310, 1e300}));
    EXPECT_EQ(point.low, point.value);
    EXPECT_EQ(point.high, point.value);
}

TEST(BoundedPose, ExactArithmeticStaysExact) {
    const BoundedPose move({{{1, 0, 0, 5}, {0, 1, 0, -7}, {0, 0, 1, 0.5}}});
    const BoundedPose mirror({{{-2, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}}});
    const auto point = (move * mirror).apply({1.5, 2, 3});
    EXPECT_EQ(point.low, (std::array<double, 3>{2, -4, 2.5}));
    EXPECT_EQ(point.high, point.low);
}

TEST(BoundedPose, InexactArithmeticIsBounded) {
    const BoundedPose turn({{{0.6, -0.8, 0, 0.1}, {0.8, 0.6, 0, 0.1}, {0, 0, 1, 0.1}}});
    const auto point = turn.apply({0.1, 0.2, 0.3});
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LT(point.low[axis], point.value[axis]);
        EXPECT_GT(point.high[axis], point.value[axis]);
        EXPECT_NEAR(point.low[axis], point.high[axis], 1e-15);
    }
}

TEST(BoundedPose, ValuesAreThoseOfPlainArithmetic) {
    const BoundedPose pose = BoundedPose({{{0.6, -0.8, 0.3, 0.1}, {0.8, 0.6, 0.7, 1e9}, {0.1, 0.2, 0.3, -0.1}}}) *
                             BoundedPose({{{0.1, 0.7, 0, 3.3}, {0.2, -0.6, 0.9, 0.1}, {0, 0.5, 0.3, 0.1}}});
    const Point3d v = {0.1, 0.2, 0.3};
    const auto& rows = pose.value().rows;
    for (int row = 0; row < 3; ++row) {
        const auto& r = rows[row];
        EXPECT_EQ(pose.apply(v).value[row], ((r[0] * v[0] + r[1] * v[1]) + r[2] * v[2]) + r[3]);
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

// Numbers of 30 bits. Exact results have about 95 bits, far more than float64 holds.
RC_GTEST_PROP(BoundedPose, BoundsHoldTheExactResult, ()) {
    __extension__ using Int128 = __int128;
    const std::int64_t most = std::int64_t(1) << 30;
    const auto a = *rc::gen::resize(1 << 20, integer_rows(most)), b = *rc::gen::resize(1 << 20, integer_rows(most));
    const auto v =
        *rc::gen::container<std::array<std::int64_t, 3>>(rc::gen::resize(1 << 20, rc::gen::inRange(-most, most)));
    const auto point =
        (BoundedPose(as_rows(a, -30)) * BoundedPose(as_rows(b, -30)))
            .apply({std::ldexp(double(v[0]), -30), std::ldexp(double(v[1]), -30), std::ldexp(double(v[2]), -30)});
    for (int row = 0; row < 3; ++row) {
        // The exact result in units of 2^-90.
        Int128 exact = Int128(a[row][3]) << 60;
        for (int k = 0; k < 3; ++k) {
            Int128 inner = Int128(b[k][3]) << 30;
            for (int j = 0; j < 3; ++j) inner += Int128(b[k][j]) * v[j];
            exact += inner * a[row][k];
        }
        RC_ASSERT(Int128(std::floor(std::ldexp(point.low[row], 90))) <= exact);
        RC_ASSERT(Int128(std::ceil(std::ldexp(point.high[row], 90))) >= exact);
        RC_ASSERT(point.high[row] - point.low[row] < 1e-13);
    }
}

}  // namespace
}  // namespace octopair::test
