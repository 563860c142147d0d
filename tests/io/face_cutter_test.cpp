// Tests how faces are cut into triangles: outlines that touch themselves exactly, with closed edges; others are told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>
#include <stop_token>
#include <string>
#include <vector>

#include "io/edge_balance.hpp"
#include "io/meshes/faces/face_cutter.hpp"
#include "io/random_outline.hpp"
#include "io/temporary.hpp"
#include "octopair/error.hpp"
#include "support/cases.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using Triangles = std::vector<io::FaceCutter::Triangle>;

const std::stop_token not_stopped;

/// Cuts a face. `is_simple`: set to whether it does not cross itself.
Triangles cut(const std::vector<Point3d>& outline, bool& is_simple) {
    io::FaceCutter cutter(not_stopped);
    is_simple = cutter.cut(outline);
    return {cutter.triangles().begin(), cutter.triangles().end()};
}

/// Returns whether the edges of the triangles are those of the outline, and others that cancel.
bool edges_match(const std::vector<Point3d>& outline, const Triangles& triangles) {
    EdgeBalance edges;
    const auto place_of = [&](std::uint32_t corner) { return outline[corner]; };
    std::vector<std::uint32_t> corners(outline.size());
    std::iota(corners.begin(), corners.end(), 0u);
    edges.add(corners, place_of, -1);
    for (const auto& triangle : triangles) edges.add(triangle, place_of, 1);
    return edges.is_zero();
}

WholeOutline corners_of(const WholeOutline& outline, const io::FaceCutter::Triangle& triangle) {
    return {outline[triangle[0]], outline[triangle[1]], outline[triangle[2]]};
}

/// Returns what is wrong with the triangles of a plane outline; empty: nothing. All numbers are exact.
std::string fault_in(const WholeOutline& outline, const Triangles& triangles) {
    const std::array<Wide, 3> whole = whole_area_of(outline);
    const unsigned axis = main_axis(whole);
    std::array<Wide, 3> sum = {0, 0, 0};
    WholeOutline thrice = outline;
    for (WholePlace& place : thrice) {
        for (std::int64_t& at : place) at *= 3;
    }
    for (const auto& triangle : triangles) {
        const WholeOutline corners = corners_of(outline, triangle);
        const std::array<Wide, 3> area = whole_area_of(corners);
        if (area[axis] != 0 && (area[axis] < 0) != (whole[axis] < 0)) return "a triangle turns the other way";
        if (area[axis] == 0 && area != std::array<Wide, 3>{0, 0, 0}) return "a triangle is in another plane";
        WholePlace middle;
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += area[k];
            middle[k] = corners[0][k] + corners[1][k] + corners[2][k];
        }
        bool on_outline = false;
        if (winding_of(thrice, middle, axis, on_outline) == 0 && !on_outline) return "a triangle is outside";
    }
    if (sum != whole) return "the areas differ";
    return edges_match(places_of(outline), triangles) ? "" : "the edges differ";
}

TEST(FaceCutter, TouchingOutlinesAreCutExactly) {
    std::uint64_t with_fill = 0, cases = 0;
    for (std::uint64_t i = 0; i < case_count(scaled(10000, 10)); ++i) {
        std::mt19937_64 random(case_seed("touching outline", i));
        const WholeOutline outline = random_outline(random);
        bool is_simple = false;
        const Triangles triangles = cut(places_of(outline), is_simple);
        ++cases;
        with_fill += triangles.size() != outline.size() - 2;
        ASSERT_TRUE(is_simple) << case_seed("touching outline", i) << ": " << text(outline);
        ASSERT_EQ(fault_in(outline, triangles), "") << case_seed("touching outline", i) << ": " << text(outline);
    }
    if (cases > 1000) {
        EXPECT_GT(with_fill, cases / 20);
    }
}

TEST(FaceCutter, CrossingOutlinesAreTold) {
    std::uint64_t told = 0, cases = 0;
    for (std::uint64_t i = 0; i < case_count(scaled(10000, 10)); ++i) {
        std::mt19937_64 random(case_seed("crossing outline", i));
        const WholeOutline outline = random_walk(7, random);
        const std::vector<Point3d> places = places_of(outline);
        bool is_simple = false;
        const Triangles triangles = cut(places, is_simple);
        ++cases;
        told += !is_simple;
        ASSERT_EQ(is_simple, !has_crossing(outline) && !overlaps(outline)) << text(outline);
        ASSERT_TRUE(edges_match(places, triangles)) << text(outline);
        if (is_simple) {
            ASSERT_EQ(fault_in(outline, triangles), "") << text(outline);
        }
    }
    if (cases > 1000) {
        EXPECT_GT(told, cases / 4);
        EXPECT_LT(told, cases * 15 / 16);
    }
}

TEST(FaceCutter, FacesThatAreNotPlaneStayClosed) {
    // Corners at one place of the plane may differ in space.
    for (std::uint64_t i = 0; i < case_count(scaled(1000, 10)); ++i) {
        std::mt19937_64 random(case_seed("uneven outline", i));
        std::vector<Point3d> places = places_of(random_outline(random));
        for (Point3d& place : places) {
            if (random() % 2 == 0) place[random() % 3] += double(random() % 3) - 1;
        }
        bool is_simple = false;
        ASSERT_TRUE(edges_match(places, cut(places, is_simple))) << case_seed("uneven outline", i);
    }
}

TEST(FaceCutter, AnyScaleIsCutAlike) {
    // An arrow with its notch at corner 3, and with corners in a row at one place.
    const std::vector<Point3d> arrow = {{0, 0, 0}, {10, 5, 0}, {10, 5, 0}, {0, 10, 0}, {4, 5, 0}, {4, 5, 0}};
    bool is_simple = false;
    const Triangles expected = cut(arrow, is_simple);
    EXPECT_TRUE(is_simple);
    for (const double scale : {0x1p-1070, 0x1p-600, 0x1p600, 0x1p1020}) {
        std::vector<Point3d> scaled_arrow = arrow;
        for (Point3d& place : scaled_arrow) {
            for (double& at : place) at *= scale;
        }
        EXPECT_EQ(cut(scaled_arrow, is_simple), expected) << scale;
        EXPECT_TRUE(is_simple);
    }
}

TEST(FaceCutter, PlaceOfRepeatedCornersDoesNotMatter) {
    // A convex face is cut from its first corner, also with a corner twice; a notch is never cut across.
    bool is_simple = false;
    const std::vector<Point3d> square = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    EXPECT_EQ(cut(square, is_simple), (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
    EXPECT_TRUE(is_simple);
    const std::vector<Point3d> in_line = {{0, 0, 0}, {3, 3, 3}, {1, 1, 1}, {2, 2, 2}};
    EXPECT_TRUE(edges_match(in_line, cut(in_line, is_simple)));
    EXPECT_TRUE(is_simple);
    const std::vector<Point3d> one_place(5, {1, 2, 3});
    EXPECT_EQ(cut(one_place, is_simple).size(), 3u);
    EXPECT_TRUE(is_simple);
}

/// Outlines with many corners, that a slow algorithm cuts slowly.
struct LargeOutline {
    std::string name;
    std::vector<Point3d> places;
};

std::vector<LargeOutline> large_outlines(std::size_t corners) {
    const auto on_circle = [&](std::size_t i, double radius) {
        const double angle = 2 * std::numbers::pi * double(i) / double(corners);
        return Point3d{radius * std::cos(angle), radius * std::sin(angle), 0};
    };
    std::vector<LargeOutline> outlines(6);
    outlines[0].name = "comb";
    outlines[0].places = {{0, -1, 0}, {double(corners), -1, 0}};
    outlines[1].name = "circle with spikes";
    outlines[2].name = "star";
    outlines[3].name = "notch with corners in line";
    outlines[3].places = {{double(corners), 1, 0}, {0, 1, 0}, {0, -1, 0}, {double(corners), -1, 0}};
    outlines[4].name = "ways there and back in a line";
    outlines[5].name = "spiral";
    for (std::size_t i = 0; i < corners; ++i) {
        const double at = double(i);
        outlines[0].places.push_back({double(corners) - at, i % 2 == 0 ? 10.0 : 0.0, 0});
        for (const double radius : {1.0, i % 2 == 0 ? 0.5 : 1.5, 1.0})
            outlines[1].places.push_back(on_circle(i, radius));
        outlines[2].places.push_back(on_circle(i, i % 2 == 0 ? 1 : 0.01));
        outlines[3].places.push_back({(i % 2 == 0 ? at : double(corners) - at) / 2 + 1, 0, 0});
        outlines[4].places.push_back({0, i % 2 == 0 ? at : -at, 1});
    }
    // A corridor that winds outward, along its outer side and back along its inner side.
    for (std::size_t i = 0; i < corners; ++i) {
        const std::size_t at = std::min(i, corners - 1 - i);
        const double angle = std::numbers::pi * double(at) / 32, radius = 1 + double(at) / 64 - (at == i ? 0 : 0.4);
        outlines[5].places.push_back({radius * std::cos(angle), 0, radius * std::sin(angle)});
    }
    return outlines;
}

TEST(FaceCutter, LargeFacesStayClosed) {
    for (const LargeOutline& large : large_outlines(scaled(20000, 10))) {
        bool is_simple = false;
        const Triangles triangles = cut(large.places, is_simple);
        EXPECT_TRUE(is_simple) << large.name;
        EXPECT_TRUE(edges_match(large.places, triangles)) << large.name;
        EXPECT_LT(triangles.size(), 4 * large.places.size()) << large.name;
    }
}

TEST(FaceCutter, LargeFacesCanBeStopped) {
    const std::stop_token stop = requested_stop();
    for (const LargeOutline& large : large_outlines(100000)) {
        io::FaceCutter cutter(stop);
        EXPECT_NE(error_of(ErrorCode::cancelled, [&] { (void)cutter.cut(large.places); }), "") << large.name;
    }
}

}  // namespace
}  // namespace octopair::test
