// Tests the rules of queries against integers of any size: on grids at all scales, on random numbers and at the limits
// of float64.
#include "scene/queries/query_rules.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cfloat>
#include <random>
#include <vector>

#include "scene/distance_oracle.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

using Point = std::array<double, 3>;

std::vector<Point> integer_points(int squared_radius) {
    const int most = int(std::sqrt(double(squared_radius))) + 1;
    std::vector<Point> points;
    for (int x = -most; x <= most; ++x) {
        for (int y = -most; y <= most; ++y) {
            for (int z = -most; z <= most; ++z) {
                if (x * x + y * y + z * z == squared_radius) points.push_back({double(x), double(y), double(z)});
            }
        }
    }
    return points;
}

/// Returns a box of zero extent at (centre + point) * 2^exponent.
Box3d scaled_box(const Point& point, const Point& centre, int exponent) {
    double at[3];
    for (unsigned axis = 0; axis < 3; ++axis) at[axis] = std::ldexp(point[axis] + centre[axis], exponent);
    return point_box(at);
}

TEST(QueryRules, SpheresTouchEveryIntegerPointOnThem) {
    for (const int radius : {3, 27, 99}) {
        const std::vector<Point> points = integer_points(radius * radius);
        for (const Point& centre : {Point{0, 0, 0}, Point{-5, 12, 700}}) {
            for (int exponent = -1074; exponent <= 1010; exponent += exponent < -1060 || exponent > 1000 ? 1 : 20) {
                Sphere sphere{{}, std::ldexp(radius, exponent)};
                for (unsigned axis = 0; axis < 3; ++axis) sphere.centre[axis] = std::ldexp(centre[axis], exponent);
                for (const Point& point : points) {
                    const Box3d box = scaled_box(point, centre, exponent);
                    ASSERT_TRUE(overlap(sphere, box))
                        << point[0] << " " << point[1] << " " << point[2] << " of " << radius << " * 2^" << exponent;
                    ASSERT_EQ(distance(box, point_box(sphere.centre)), sphere.radius);
                    const Sphere smaller{{sphere.centre[0], sphere.centre[1], sphere.centre[2]},
                                         std::nextafter(sphere.radius, 0)};
                    ASSERT_FALSE(overlap(smaller, box));
                }
            }
        }
    }
}

/// Random numbers of one kind: small integers, small integers times a power of 2, uniform from -1 to 1, any bits,
/// special values of float64, or a mixture.
class Numbers {
public:
    explicit Numbers(std::mt19937_64& random)
        : random_(random), kind_(random() % 6), exponent_(int(random() % 2084) - 1074) {}

    double draw() {
        switch (kind_ == 5 ? random_() % 5 : kind_) {
            case 0:
                return double(int(random_() % 81) - 40);
            case 1:
                return std::ldexp(double(int(random_() % 81) - 40), exponent_);
            case 2:
                return std::uniform_real_distribution<>(-1, 1)(random_);
            case 3:
                return any_bits();
            default:
                return an_end();
        }
    }
    Box3d box() {
        Box3d box;
        for (int axis = 0; axis < 3; ++axis) {
            const double a = draw(), b = random_() % 2 == 0 ? a : draw();
            box.min[axis] = std::min(a, b);
            box.max[axis] = std::max(a, b);
        }
        return box;
    }

private:
    double any_bits() {
        const auto number = std::bit_cast<double>(random_());
        return std::isfinite(number) ? number : 0;
    }
    double an_end() {
        constexpr std::array<double, 8> ends = {0, DBL_TRUE_MIN,    3 * DBL_TRUE_MIN, DBL_MIN,
                                                1, 1 + DBL_EPSILON, DBL_MAX / 2,      DBL_MAX};
        const double end = ends[random_() % ends.size()];
        return random_() % 2 == 0 ? -end : end;
    }

    std::mt19937_64& random_;
    std::uint64_t kind_;
    int exponent_;
};

TEST(QueryRules, SpheresAgreeWithIntegers) {
    std::mt19937_64 random(1);
    std::uint64_t touching = 0;
    const std::uint64_t cases = scaled(40000, 4000);
    for (std::uint64_t i = 0; i < cases; ++i) {
        Numbers numbers(random);
        const Box3d box = numbers.box();
        Sphere sphere{{numbers.draw(), numbers.draw(), numbers.draw()}, std::abs(numbers.draw())};
        if (random() % 4 != 0) sphere.radius = rounded_distance(point_box(sphere.centre), box);
        if (sphere.radius == infinity) sphere.radius = DBL_MAX;
        if (random() % 4 == 0) sphere.radius = std::nextafter(sphere.radius, random() % 2 == 0 ? 0 : DBL_MAX);
        const bool expected = exactly_touches(sphere, box);
        touching += expected ? 1 : 0;
        ASSERT_EQ(overlap(sphere, box), expected) << i;
    }
    EXPECT_GT(touching, cases / 4);
    EXPECT_LT(touching, cases - cases / 8);
}

TEST(QueryRules, DistancesAreTheExactOnesRounded) {
    std::mt19937_64 random(2);
    const std::uint64_t cases = scaled(20000, 2000);
    for (std::uint64_t i = 0; i < cases; ++i) {
        Numbers numbers(random);
        const Box3d a = numbers.box(), b = numbers.box();
        const double expected = rounded_distance(a, b);
        ASSERT_EQ(distance(a, b), expected) << i;
        ASSERT_EQ(distance(b, a), expected) << i;
        const double square = square_at_least(a, b);
        ASSERT_LE(square, square_at_most(expected)) << i;
        if (expected > 0x1p-440 && expected < 0x1p490) {
            ASSERT_GT(square, square_at_most(expected * (1 - 0x1p-40))) << i;
        }
    }
}

TEST(QueryRules, DistancesCompareAsIntegersDo) {
    std::mt19937_64 random(3);
    std::uint64_t equal = 0;
    const std::uint64_t cases = scaled(40000, 4000);
    for (std::uint64_t i = 0; i < cases; ++i) {
        Numbers numbers(random);
        const Box3d place = numbers.box(), a = numbers.box();
        Box3d b = numbers.box();
        if (i % 4 == 0) {  // distances to a and b are equal or nearly equal
            b = a;
            std::swap(b.min[2], b.min[i % 3]);
            std::swap(b.max[2], b.max[i % 3]);
            if (i % 8 == 0) b.max[0] = std::min(std::nextafter(b.max[0], DBL_MAX), DBL_MAX);
        }
        const Integer to_a = exact_squared_distance(place, a), to_b = exact_squared_distance(place, b);
        const int expected = int(to_a > to_b) - int(to_a < to_b);
        equal += expected == 0 ? 1 : 0;
        ASSERT_EQ(compare_distances(place, a, b), expected) << i;
        ASSERT_EQ(compare_distances(place, b, a), -expected) << i;
        ASSERT_TRUE(expected >= 0 || distance(place, a) <= distance(place, b)) << i;
    }
    EXPECT_GT(equal, cases / 20);
}

TEST(QueryRules, AtTheEndsOfFloat64) {
    const Box3d low{{-DBL_MAX, 0, 0}, {-DBL_MAX, 0, 0}}, high{{DBL_MAX, 0, 0}, {DBL_MAX, 0, 0}};
    const Box3d corner{{DBL_MAX, DBL_MAX, 0}, {DBL_MAX, DBL_MAX, 0}}, middle{{0, 0, 0}, {0, 0, 0}};
    EXPECT_EQ(distance(low, high), infinity);
    EXPECT_EQ(distance(middle, high), DBL_MAX);
    EXPECT_EQ(distance(middle, corner), infinity);
    EXPECT_EQ(compare_distances(low, high, corner), -1);
    EXPECT_TRUE(overlap(Sphere{{0, 0, 0}, DBL_MAX}, high));
    EXPECT_FALSE(overlap(Sphere{{0, DBL_TRUE_MIN, 0}, DBL_MAX}, high));
    EXPECT_FALSE(overlap(Sphere{{-DBL_TRUE_MIN, 0, 0}, DBL_MAX}, high));
    EXPECT_FALSE(overlap(Sphere{{-DBL_MAX, 0, 0}, DBL_MAX}, high));
    EXPECT_FALSE(overlap(Sphere{{0, 0, 0}, DBL_MAX}, corner));

    const Box3d least{{DBL_TRUE_MIN, 0, 0}, {1, 1, 1}}, edge{{DBL_TRUE_MIN, DBL_TRUE_MIN, 0}, {1, 1, 1}};
    EXPECT_EQ(distance(middle, least), DBL_TRUE_MIN);
    EXPECT_EQ(distance(middle, edge), DBL_TRUE_MIN);  // exactly: 1.41 times DBL_TRUE_MIN
    EXPECT_EQ(compare_distances(middle, least, edge), -1);
    EXPECT_FALSE(overlap(Sphere{{0, 0, 0}, 0}, least));
    EXPECT_TRUE(overlap(Sphere{{0, 0, 0}, DBL_TRUE_MIN}, least));
    EXPECT_FALSE(overlap(Sphere{{0, 0, 0}, DBL_TRUE_MIN}, edge));
    EXPECT_TRUE(overlap(Sphere{{0, 0, 0}, 2 * DBL_TRUE_MIN}, edge));
}

}  // namespace
}  // namespace octopair::test
