// Tests the distance of triangles, and the place, kind and depth of their contacts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "geometry/vector.hpp"
#include "narrow_phase/exact/triangle_contact.hpp"
#include "narrow_phase/exact/triangle_pair.hpp"
#include "narrow_phase/exact_oracle.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using vector::cross;
using vector::dot;
using vector::length;
using vector::minus;
using vector::plus;
using vector::times;

/// Returns the excess of the areas that `place` spans with the edges over the triangle's area: 0 if `place` is on the
/// triangle. For a degenerate triangle, uses lengths instead of areas.
double off_triangle(const Point3d& place, const Triangle3d& triangle) {
    const auto area = [](const Point3d& a, const Point3d& b, const Point3d& c) {
        return length(cross(minus(b, a), minus(c, a)));
    };
    const auto& [a, b, c] = triangle;
    double excess = area(place, a, b) + area(place, b, c) + area(place, c, a) - area(a, b, c);
    if (is_degenerate(triangle)) {
        const auto [low, high] = std::minmax_element(triangle.begin(), triangle.end());
        excess = length(minus(place, *low)) + length(minus(place, *high)) - length(minus(*high, *low));
    }
    return excess;
}

/// Kinds of pairs whose coordinates are around 1.
constexpr std::array<unsigned, 4> near_kinds = {0, 1, 2, 3};

TEST(TriangleGap, APointIsATriangleOfOneCorner) {
    std::mt19937 random(9);
    unsigned on_triangles = 0;
    for (unsigned i = 0; i < scaled(20000, 20); ++i) {
        const auto& [a, b] = some_pair(i % 8, random);
        for (const Point3d& point : {a[0], b[1], times(plus(b[0], b[1]), 0.5)}) {
            const double expected = triangle_gap({point, point, point}, b).distance, found = triangle_gap(point, b);
            double largest = 0;
            for (const Point3d& corner : {point, b[0], b[1], b[2]}) {
                for (const double at : corner) largest = std::max(largest, std::abs(at));
            }
            ASSERT_NEAR(found, expected, largest * 1e-15) << text(TrianglePair{Triangle3d{point, point, point}, b});
            ASSERT_EQ(found == 0, expected == 0) << text(TrianglePair{Triangle3d{point, point, point}, b});
            on_triangles += found == 0;
        }
    }
    EXPECT_GT(on_triangles, scaled(20000, 20));
}

TEST(TriangleGap, NoPlaneTellsThatItIsLonger) {
    std::mt19937 random(6);
    unsigned apart = 0;
    for (unsigned i = 0; i < scaled(20000, 20); ++i) {
        const auto pair = some_pair(near_kinds[i % 4], random);
        const auto& [a, b] = pair;
        const TriangleGap gap = triangle_gap(a, b);
        ASSERT_TRUE(gap.distance == 0 || !triangles_meet(a, b)) << text(pair);
        const auto& [on_a, on_b] = gap.nearest;
        ASSERT_NEAR(off_triangle(on_a, a), 0, 1e-7) << text(pair);
        ASSERT_NEAR(off_triangle(on_b, b), 0, 1e-7) << text(pair);
        const Point3d way = minus(on_b, on_a);
        ASSERT_NEAR(length(way), gap.distance, 1e-14) << text(pair);
        if (gap.distance < 1e-3) continue;
        ++apart;
        // The planes across `way` at the nearest points separate the triangles.
        for (const Point3d& corner : a) ASSERT_LE(dot(way, minus(corner, on_a)), 1e-11 * gap.distance) << text(pair);
        for (const Point3d& corner : b) ASSERT_GE(dot(way, minus(corner, on_b)), -1e-11 * gap.distance) << text(pair);
    }
    EXPECT_GT(apart, scaled(2000, 20));
}

TEST(TriangleGap, ScalesWithTheWorld) {
    std::mt19937 random(7);
    for (unsigned i = 0; i < scaled(2000, 20); ++i) {
        const auto pair = some_pair(i % 2 == 0 ? 0 : 3, random);
        const double distance = triangle_gap(pair[0], pair[1]).distance;
        for (const int exponent : {-1000, -300, 300, 1020}) {
            auto scaled = pair;
            for (auto& triangle : scaled) {
                for (Point3d& corner : triangle) corner = times(corner, std::ldexp(1.0, exponent));
            }
            const TriangleGap gap = triangle_gap(scaled[0], scaled[1]);
            ASSERT_NEAR(std::ldexp(gap.distance, -exponent), distance, 1e-14) << exponent << text(pair);
        }
    }
}

TEST(TriangleGap, OfDegenerateTriangles) {
    const Triangle3d point = {{{0, 0, 3}, {0, 0, 3}, {0, 0, 3}}}, segment = {{{-1, 0, 0}, {5, 0, 0}, {1, 0, 0}}};
    const Triangle3d across = {{{2, -1, 4}, {2, 7, 4}, {2, 7, 4}}}, flat = {{{-9, -9, 1}, {9, -9, 1}, {0, 9, 1}}};
    EXPECT_EQ(triangle_gap(point, segment).distance, 3);
    EXPECT_EQ(triangle_gap(segment, across).distance, 4);
    EXPECT_EQ(triangle_gap(flat, point).distance, 2);
    EXPECT_EQ(triangle_gap(flat, segment).distance, 1);
    EXPECT_EQ(triangle_gap(point, point).distance, 0);
    EXPECT_EQ(triangle_gap(point, point).nearest[1], point[0]);
}

TEST(TriangleContact, IsThatOfRationalNumbers) {
    std::mt19937 random(8);
    std::array<unsigned, 4> seen = {};
    for (unsigned i = 0; i < scaled(1500, 10); ++i) {
        const auto pair = some_pair(near_kinds[i % 4], random);
        const auto& [a, b] = pair;
        const TriangleContact contact = triangle_contact(a, b);
        const OracleContact expected = oracle_contact(a, b);
        const bool flat = is_degenerate(a) || is_degenerate(b);
        ASSERT_EQ(contact.meeting == TriangleMeeting::none, expected.corners == 0) << text(pair);
        ASSERT_EQ(contact.meeting == TriangleMeeting::overlapping, expected.area) << text(pair);
        ASSERT_EQ(contact.meeting == TriangleMeeting::crossing, !flat && expected.inside && !expected.area)
            << text(pair);
        ASSERT_TRUE(flat || contact.count == expected.corners) << text(pair);
        for (unsigned k = 0; k < contact.count; ++k) {
            ASSERT_NEAR(off_triangle(contact.points[k], a), 0, 1e-7) << text(pair);
            ASSERT_NEAR(off_triangle(contact.points[k], b), 0, 1e-7) << text(pair);
        }
        ++seen[std::size_t(contact.meeting)];
    }
    for (const unsigned some : seen) EXPECT_GT(some, scaled(10, 10));
}

TEST(TriangleContact, IsAPolygonInOrder) {
    const Triangle3d up = {{{0, 0, 0}, {6, 0, 0}, {3, 6, 0}}}, down = {{{0, 4, 0}, {6, 4, 0}, {3, -2, 0}}};
    const TriangleContact contact = triangle_contact(up, down);
    ASSERT_EQ(contact.count, 6U);
    for (unsigned i = 0; i < 6; ++i) {
        const Point3d &at = contact.points[i], &next = contact.points[(i + 1) % 6];
        EXPECT_GT(cross(minus(next, at), minus(contact.points[(i + 2) % 6], next))[2], 0);
    }
}

TEST(TriangleDepth, IsTheShortestWayOut) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> at(-1, 1);
    unsigned deep = 0;
    for (unsigned i = 0; i < scaled(10000, 20); ++i) {
        const auto pair = some_pair(near_kinds[i % 4], random);
        const auto& [a, b] = pair;
        if (!triangles_meet(a, b)) continue;
        const TriangleDepth way = triangle_depth(a, b);
        const auto moved = [&](const Point3d& by) {
            return Triangle3d{plus(b[0], by), plus(b[1], by), plus(b[2], by)};
        };
        if (a[0] != a[1] || a[1] != a[2] || b[0] != b[1] || b[1] != b[2]) {
            ASSERT_NEAR(length(way.normal), 1, 1e-12) << text(pair);
            ASSERT_FALSE(triangles_meet(a, moved(times(way.normal, way.depth + 1e-9)))) << text(pair);
        }
        if (way.depth < 1e-6) continue;
        ++deep;
        const Point3d some = {at(random), at(random), at(random)};
        ASSERT_TRUE(triangles_meet(a, moved(times(some, 0.999 * way.depth / length(some))))) << text(pair);
    }
    EXPECT_GT(deep, scaled(500, 20));
}

}  // namespace
}  // namespace octopair::test
