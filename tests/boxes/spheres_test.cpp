// Tests the boxes of spheres against exact integers: rounded outward, and no larger than necessary.
#include "boxes/sphere_boxes.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/calls.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

__extension__ using Wide = __int128;

/// Returns value / 2^exponent. Requires: the result is a whole number below 2^127.
Wide scaled(double value, int exponent) {
    const double whole = std::ldexp(value, -exponent);
    EXPECT_EQ(whole, std::trunc(whole));
    return Wide(whole);
}

struct Dyadic {
    std::int64_t mantissa;
    int exponent;
    double value() const { return std::ldexp(double(mantissa), exponent); }
};

rc::Gen<Dyadic> dyadic(bool positive) {
    const std::int64_t top = std::int64_t(1) << 53;
    return rc::gen::map(
        rc::gen::pair(rc::gen::inRange<std::int64_t>(positive ? 0 : -top, top + 1), rc::gen::inRange(-40, 10)),
        [](const std::pair<std::int64_t, int>& p) {
            return Dyadic{p.first, p.second};
        });
}

RC_GTEST_PROP(Spheres, Float64BoxIsTheSmallestThatHoldsTheExactOne, ()) {
    const Dyadic centre = *rc::gen::resize(1000, dyadic(false)), radius = *rc::gen::resize(1000, dyadic(true));
    // Two bits finer than both numbers, so that the neighbours of the ends are also whole numbers.
    const int unit = std::min(centre.exponent, radius.exponent) - 2;
    const Wide c = scaled(centre.value(), unit), r = scaled(radius.value(), unit);
    const auto x = centre.value();
    const Box3d box = box_of_sphere(SphereRow<double>{{x, x, x}, radius.value()});
    for (int axis = 0; axis < 3; ++axis) {
        RC_ASSERT(scaled(box.max[axis], unit) >= c + r);
        RC_ASSERT(scaled(box.min[axis], unit) <= c - r);
        const double below = std::nextafter(box.max[axis], -1e300), above = std::nextafter(box.min[axis], 1e300);
        if (std::abs(below) > std::ldexp(1.0, unit + 53)) RC_ASSERT(scaled(below, unit) < c + r);
        if (std::abs(above) > std::ldexp(1.0, unit + 53)) RC_ASSERT(scaled(above, unit) > c - r);
    }
}

RC_GTEST_PROP(Spheres, Float32BoxIsTheSmallestThatHoldsTheFloat64One, ()) {
    const auto number = rc::gen::map(rc::gen::pair(rc::gen::inRange(-16777216, 16777217), rc::gen::inRange(-60, 40)),
                                     [](const std::pair<int, int>& p) { return std::ldexp(float(p.first), p.second); });
    const float centre = *rc::gen::resize(1000, number), radius = std::abs(*rc::gen::resize(1000, number));
    const Box3f box = box_of_sphere(SphereRow<float>{{centre, centre, centre}, radius});
    const double low = double(centre) - double(radius), high = double(centre) + double(radius);
    RC_ASSERT(double(box.min[0]) <= low && double(std::nextafter(box.min[0], 1e38f)) > low);
    RC_ASSERT(double(box.max[1]) >= high && double(std::nextafter(box.max[1], -1e38f)) < high);
}

TEST(Spheres, ExactSumsStayExact) {
    const Box3d box = box_of_sphere(SphereRow<double>{{1, -2, 0}, 0.25});
    EXPECT_EQ(box.min[0], 0.75);
    EXPECT_EQ(box.max[1], -1.75);
    EXPECT_EQ(box.min[2], -0.25);
}

TEST(Spheres, InexactSumsGoOutward) {
    const double tiny = 1e-30;
    const Box3d box = box_of_sphere(SphereRow<double>{{1, -1, 0}, tiny});
    EXPECT_EQ(box.min[0], std::nextafter(1.0, 0.0));
    EXPECT_EQ(box.max[0], std::nextafter(1.0, 2.0));
    EXPECT_EQ(box.min[1], std::nextafter(-1.0, -2.0));
    EXPECT_EQ(box.max[2], tiny);
    const Box3f narrow = box_of_sphere(SphereRow<float>{{1, 1, 1}, 1e-9f});
    EXPECT_EQ(narrow.min[0], std::nextafter(1.0f, 0.0f));
    EXPECT_EQ(narrow.max[0], std::nextafter(1.0f, 2.0f));
}

TEST(Spheres, DenormalsAndEnds) {
    const double least = std::numeric_limits<double>::denorm_min();
    EXPECT_EQ(box_of_sphere(SphereRow<double>{{0, 0, 0}, least}).min[0], -least);
    const double huge = std::numeric_limits<double>::max();
    EXPECT_TRUE(std::isinf(box_of_sphere(SphereRow<double>{{huge, 0, 0}, huge}).max[0]));
    EXPECT_EQ(box_of_sphere(SphereRow<double>{{huge, 0, 0}, huge}).min[0], 0.0);
}

TEST(Spheres, ConversionCanBeStopped) {
    const std::vector<SphereRow<float>> spheres = {{{0, 0, 0}, 1}};
    std::vector<Box3f> boxes(1);
    (void)error_of(ErrorCode::cancelled, [&] { boxes_of(spheres, boxes, requested_stop()); });
}

TEST(Spheres, ErrorsNameTheSphere) {
    const std::vector<SphereRow<double>> spheres = {{{0, 0, 0}, 1}, {{0, 0, 0}, -0.5}};
    std::vector<Box3d> boxes(2);
    try {
        boxes_of(spheres, boxes);
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "object 1: radius is -0.5, not a finite number >= 0");
        EXPECT_EQ(error.code(), ErrorCode::bad_input);
        EXPECT_EQ(error.place().value().index, 1u);
    }
}

}  // namespace
}  // namespace octopair::test
