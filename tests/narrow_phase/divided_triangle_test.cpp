// Tests that DividedTriangle visits every face: edges that reach beyond the triangle divide it like lines, so the sides of a point
// of all lines name its face.
#include "narrow_phase/exact/divided_triangle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "narrow_phase/exact/orientation.hpp"
#include "samples/random.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using samples::RandomStream;
using Face = std::vector<int>;  // sides of all lines

constexpr Triangle3d right_triangle = {{{0, 0, 0}, {12, 0, 0}, {0, 12, 0}}};
constexpr unsigned along_z = 2;

/// Returns an edge far beyond the triangle, through two of its points on a grid.
Segment3d long_edge(RandomStream& random) {
    for (;;) {
        const auto grid = [&] { return double(random.below(13)); };
        const double x = grid(), y = grid(), way_x = grid() - 6, way_y = grid() - 6;
        if (x + y > 12 || (way_x == 0 && way_y == 0)) continue;
        return {{{x - 64 * way_x, y - 64 * way_y, 0}, {x + 64 * way_x, y + 64 * way_y, 0}}};
    }
}

/// Returns the faces in which a fine grid of points has one, found by testing all its points.
std::set<Face> faces_of_points(const std::vector<Segment3d>& lines) {
    std::set<Face> faces;
    constexpr int steps = 400;
    for (int i = 1; i < steps; ++i) {
        for (int k = 1; i + k < steps; ++k) {
            Face face;
            const Point3d point = {12.0 * i / steps, 12.0 * k / steps, 0};
            for (const Segment3d& line : lines) face.push_back(line_side(line[0], line[1], point, along_z));
            if (std::find(face.begin(), face.end(), 0) == face.end()) faces.insert(face);
        }
    }
    return faces;
}

TEST(DividedTriangle, VisitsEveryFace) {
    std::size_t most = 0;
    for (std::uint64_t scene = 0; scene < scaled(200, 10); ++scene) {
        SCOPED_TRACE("scene " + std::to_string(scene));
        RandomStream random(18, scene);
        std::vector<Segment3d> lines;
        for (std::uint64_t i = 0, count = random.below(7); i < count; ++i) lines.push_back(long_edge(random));
        DividedTriangle divided(right_triangle, projection_of(right_triangle));
        // The third corner is beside the plane, so only the edge divides.
        for (const Segment3d& line : lines) divided.divide({line[0], line[1], Point3d{1, 1, 1}});
        std::set<Face> visited;
        EXPECT_FALSE(divided.any_face([&](const NearbyPoint& point) {
            Face face;
            for (const Segment3d& line : lines) face.push_back(point.line_side(line[0], line[1], along_z));
            visited.insert(face);
            return false;
        }));
        for (const Face& face : faces_of_points(lines)) EXPECT_TRUE(visited.contains(face));
        most = std::max(most, visited.size());
    }
    EXPECT_GT(most, 10u);
}

TEST(DividedTriangle, VisitsTheFaceWithinEdges) {
    // A square of edges that end inside the triangle: one face inside, one outside.
    const std::vector<Point3d> square = {{2, 2, 0}, {4, 2, 0}, {4, 4, 0}, {2, 4, 0}};
    DividedTriangle divided(right_triangle, projection_of(right_triangle));
    for (std::size_t i = 0; i < 4; ++i) divided.divide({square[i], square[(i + 1) % 4], Point3d{1, 1, 1}});
    std::set<bool> inside;
    divided.any_face([&](const NearbyPoint& point) {
        bool all = true;
        for (std::size_t i = 0; i < 4; ++i) all &= point.line_side(square[i], square[(i + 1) % 4], along_z) > 0;
        inside.insert(all);
        return false;
    });
    EXPECT_EQ(inside, (std::set<bool>{false, true}));
}

TEST(DividedTriangle, VisitsTheFaceWithinAPinwheel) {
    // Four edges, each of which ends on the next, around a square; and their mirror image.
    for (const bool mirrored : {false, true}) {
        const auto point = [&](double x, double y) { return mirrored ? Point3d{y, x, 0} : Point3d{x, y, 0}; };
        const std::vector<Segment3d> edges = {{{point(1, 2), point(4, 2)}},
                                              {{point(4, 1), point(4, 4)}},
                                              {{point(5, 4), point(2, 4)}},
                                              {{point(2, 5), point(2, 2)}}};
        DividedTriangle divided(right_triangle, projection_of(right_triangle));
        for (const Segment3d& edge : edges) divided.divide({edge[0], edge[1], Point3d{1, 1, 1}});
        const bool visited = divided.any_face([&](const NearbyPoint& near) {
            return std::all_of(edges.begin(), edges.end(), [&](const Segment3d& edge) {
                return near.line_side(edge[0], edge[1], along_z) == (mirrored ? -1 : 1);
            });
        });
        EXPECT_TRUE(visited);
    }
}

}  // namespace
}  // namespace octopair::test
