// Tests that rays through edges and corners of closed meshes count crossings correctly, and that points on a triangle
// are detected.
#include "narrow_phase/exact/ray_parity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "narrow_phase/exact_oracle.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using Tetrahedron = std::array<Point3d, 4>;

std::array<Triangle3d, 4> faces_of(const Tetrahedron& corners) {
    const auto& [a, b, c, d] = corners;
    return {Triangle3d{a, b, c}, Triangle3d{a, b, d}, Triangle3d{a, c, d}, Triangle3d{b, c, d}};
}

/// Returns whether `place` is on the same side of each face as the opposite corner.
bool is_inside(const Tetrahedron& corners, const Point3d& place) {
    for (std::size_t i = 0; i < 4; ++i) {
        Tetrahedron face = corners;
        std::swap(face[i], face[3]);
        const int side = oracle_plane_side(face);
        face[3] = place;
        if (side == 0 || oracle_plane_side(face) != side) return false;
    }
    return true;
}

TEST(RayParity, TellsInsideFromOutsideAlongEveryAxis) {
    std::mt19937 random(4);
    unsigned inside = 0, outside = 0, on_surface = 0;
    for (unsigned round = 0; round < scaled(600, 10); ++round) {
        // Intersecting tetrahedra form one closed mesh. Their corners and edges are often in line with `place`.
        std::vector<Tetrahedron> solids(3);
        std::vector<Triangle3d> faces;
        const double scale = round % 3 == 0 ? 1 : round % 3 == 1 ? 1e6 / 3 : 1e-310;
        const auto some_place = [&](unsigned first, unsigned step) {
            const auto some = [&] { return double(first + step * (random() % 3)) * scale; };
            return Point3d{some(), some(), some()};
        };
        for (Tetrahedron& solid : solids) {
            for (Point3d& corner : solid) corner = some_place(0, 2);
            for (const Triangle3d& face : faces_of(solid)) faces.push_back(face);
        }
        const Point3d place = some_place(1, 1);
        const auto holds = [&](const Triangle3d& face) { return point_on_triangle(place, face); };
        if (std::any_of(faces.begin(), faces.end(), holds)) {
            ++on_surface;
            continue;
        }
        const auto around = std::count_if(solids.begin(), solids.end(),
                                          [&](const Tetrahedron& solid) { return is_inside(solid, place); });
        for (unsigned axis = 0; axis < 3; ++axis) {
            const auto crossed = std::count_if(faces.begin(), faces.end(),
                                               [&](const Triangle3d& face) { return ray_crosses(place, face, axis); });
            ASSERT_EQ(crossed % 2, around % 2) << ::testing::PrintToString(faces) << ::testing::PrintToString(place);
        }
        ++(around % 2 != 0 ? inside : outside);
    }
    for (const unsigned some : {inside, outside, on_surface}) EXPECT_GE(some, scaled(10, 20));
}

TEST(RayParity, GoesOneWayAndCountsBothSides) {
    const Triangle3d ahead = {{{1, -1, -1}, {1, 2, -1}, {1, -1, 2}}}, turned = {ahead[0], ahead[2], ahead[1]};
    EXPECT_TRUE(ray_crosses({0, 0, 0}, ahead));
    EXPECT_TRUE(ray_crosses({0, 0, 0}, turned));
    EXPECT_FALSE(ray_crosses({2, 0, 0}, ahead));
    EXPECT_FALSE(ray_crosses({2, 0, 0}, turned));
    EXPECT_FALSE(ray_crosses({0, 0, 0}, ahead, 1));
    EXPECT_FALSE(ray_crosses({0, 3, 0}, ahead));
}

TEST(PointOnTriangle, IsThatOfRationalNumbers) {
    std::mt19937 random(5);
    unsigned on = 0;
    for (unsigned i = 0; i < scaled(800, 10); ++i) {
        const auto [triangle, other] = some_pair(i % pair_kinds, random);
        const Point3d place = other[0];
        const bool expected = oracle_meet(triangle, {place, place, place});
        ASSERT_EQ(point_on_triangle(place, triangle), expected)
            << ::testing::PrintToString(triangle) << ::testing::PrintToString(place);
        on += unsigned(expected);
    }
    EXPECT_GT(on, scaled(30, 10));
}

}  // namespace
}  // namespace octopair::test
