// Tests the least-squares fit on known curves.
#include "paper/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "machine/median.hpp"

namespace octopair::paper {
namespace {

using bench::median;

constexpr double sizes[] = {1e5, 2.5e5, 5e5, 1e6, 1.5e6, 2e6};

std::vector<Sample> samples_of(const std::function<double(double)>& seconds, double spread) {
    std::vector<Sample> samples;
    for (const double n : sizes) samples.push_back({n, seconds(n), spread});
    return samples;
}

TEST(Fit, MedianAndSpread) {
    EXPECT_EQ(median({}), 0);
    EXPECT_EQ(median({3}), 3);
    EXPECT_EQ(median({9, 1, 5}), 5);
    EXPECT_EQ(median({4, 1, 2, 3}), 3);
    EXPECT_EQ(relative_spread({}), 0);
    EXPECT_EQ(relative_spread({2, 2, 2}), 0);
    EXPECT_DOUBLE_EQ(relative_spread({8, 10, 11, 10, 90}), 0.1);
}

TEST(Fit, FindsALine) {
    const Fits fits = fit(samples_of([](double n) { return 2e-8 * n; }, 0.01));
    EXPECT_NEAR(fits.linear.a, 2e-8, 1e-20);
    EXPECT_NEAR(fits.linear.residual, 0, 1e-12);
    EXPECT_GT(fits.n_log_n.residual, 0.05);
    EXPECT_EQ(fits.growth, Growth::linear);
    EXPECT_DOUBLE_EQ(fits.spread, 0.01);
}

TEST(Fit, FindsNLogN) {
    const Fits fits = fit(samples_of([](double n) { return 3e-9 * n * std::log2(n); }, 0.01));
    EXPECT_NEAR(fits.n_log_n.a, 3e-9, 1e-20);
    EXPECT_NEAR(fits.n_log_n.residual, 0, 1e-12);
    EXPECT_EQ(fits.growth, Growth::n_log_n);
}

TEST(Fit, CannotTellWithinTheSpread) {
    const Fits fits = fit(samples_of([](double n) { return 2e-8 * n; }, 0.2));
    EXPECT_EQ(fits.growth, Growth::unclear);
    EXPECT_EQ(growth_text(fits.growth), "cannot tell");
}

TEST(Fit, CannotTellFromLessThanTwo) {
    EXPECT_EQ(fit({}).growth, Growth::unclear);
    const std::vector<Sample> one = {{1e6, 0.5, 0}};
    EXPECT_EQ(fit(one).growth, Growth::unclear);
    EXPECT_DOUBLE_EQ(fit(one).linear.a, 5e-7);
}

/// For one time 10% above a line and one 10% below, the fit of relative residuals gives an `a` below the line's slope.
TEST(Fit, ResidualsAreRelative) {
    const std::vector<Sample> samples = {{1000, 1.1e-5, 0}, {1000000, 0.9e-2, 0}};
    const Fits fits = fit(samples);
    const double x = 1 / 1.1, y = 1 / 0.9;
    EXPECT_NEAR(fits.linear.a, 1e-8 * (x + y) / (x * x + y * y), 1e-20);
    EXPECT_NEAR(fits.linear.residual, 0.1, 0.005);
}

}  // namespace
}  // namespace octopair::paper
