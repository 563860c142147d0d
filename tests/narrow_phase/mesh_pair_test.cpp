// Tests pairs of posed meshes: the hierarchies give the result of a test of all pairs of triangles.
#include "narrow_phase/mesh/mesh_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "narrow_phase/exact/triangle_pair.hpp"
#include "narrow_phase/mesh/mesh_walk.hpp"
#include "samples/meshes.hpp"
#include "samples/random.hpp"

namespace octopair::test {
namespace {

using samples::box_mesh;
using samples::random_pose;
using samples::RandomStream;
using samples::sphere_mesh;
using samples::torus_mesh;
using Numbers = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Triangle3d triangle_of(const shape::Mesh& mesh, const Pose& pose, std::size_t i) {
    const auto& [a, b, c] = mesh.triangles[i];
    return {vector::posed(pose, mesh.vertices[a]), vector::posed(pose, mesh.vertices[b]),
            vector::posed(pose, mesh.vertices[c])};
}

/// Two meshes with their trees and adjustable poses.
struct Couple {
    Couple(shape::Mesh first, shape::Mesh second)
        : mesh_a(std::move(first)),
          mesh_b(std::move(second)),
          tree_a(make_mesh_tree(mesh_a)),
          tree_b(make_mesh_tree(mesh_b)) {}

    PosedMesh a() const { return {*tree_a, pose_a}; }
    PosedMesh b() const { return {*tree_b, pose_b}; }

    /// Returns all pairs of triangles that intersect, from a test of all pairs.
    Numbers all_meeting() const {
        Numbers meeting;
        for (std::uint32_t i = 0; i < mesh_a.triangles.size(); ++i) {
            const Triangle3d triangle = triangle_of(mesh_a, pose_a, i);
            for (std::uint32_t j = 0; j < mesh_b.triangles.size(); ++j) {
                if (triangles_meet(triangle, triangle_of(mesh_b, pose_b, j))) meeting.insert({i, j});
            }
        }
        return meeting;
    }

    Numbers visited() const {
        Numbers meeting;
        visit_meeting_triangles(a(), b(), [&](const MeetingTriangles& at) {
            EXPECT_TRUE(meeting.insert({at.number_a, at.number_b}).second);
            EXPECT_EQ(at.a, triangle_of(mesh_a, pose_a, at.number_a));
            return true;
        });
        return meeting;
    }

    double min_gap() const {
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t i = 0; i < mesh_a.triangles.size(); ++i) {
            for (std::uint32_t j = 0; j < mesh_b.triangles.size(); ++j) {
                least = std::min(least,
                                 triangle_gap(triangle_of(mesh_a, pose_a, i), triangle_of(mesh_b, pose_b, j)).distance);
            }
        }
        return least;
    }

    void expect_as_by_all_pairs() const {
        const Numbers meeting = all_meeting();
        EXPECT_EQ(visited(), meeting);
        EXPECT_EQ(surfaces_meet(a(), b()), !meeting.empty());
    }

    shape::Mesh mesh_a, mesh_b;
    std::shared_ptr<const MeshTree> tree_a, tree_b;
    Pose pose_a, pose_b;
};

void scale(Pose& pose, const Point3d& by) {
    for (auto& row : pose.rows) {
        for (int column = 0; column < 3; ++column) row[column] *= by[column];
    }
}

void move(Pose& pose, double by) {
    for (auto& row : pose.rows) row[3] += by;
}

TEST(MeshPair, MeetsWhereSomeTrianglesMeet) {
    Couple couple(torus_mesh({20, 12, 0.3, 1}), sphere_mesh(0.8, 2));
    RandomStream random(7, 0);
    unsigned meeting = 0;
    for (int round = 0; round < 60; ++round) {
        couple.pose_a = random_pose(random, 2);
        couple.pose_b = random_pose(random, 2);
        if (round % 3 == 1) scale(couple.pose_a, {-1, 0.5, 2});
        if (round % 5 == 1) scale(couple.pose_b, {1, 0, 1});
        if (round % 4 == 3) {
            move(couple.pose_a, 1e6);
            move(couple.pose_b, 1e6);
        }
        couple.expect_as_by_all_pairs();
        meeting += surfaces_meet(couple.a(), couple.b());
    }
    EXPECT_GT(meeting, 10u);
    EXPECT_LT(meeting, 50u);
}

/// Returns the pairs of leaves in the order of a traversal that tests two boxes with Separation::apart().
std::vector<NodePair> leaves_within(MeshWalk walk) {
    std::vector<NodePair> leaves;
    while (!walk.waiting.empty()) {
        const NodePair at = walk.waiting.pop();
        const MeshNode &a = walk.nodes_a[at.a], &b = walk.nodes_b[at.b];
        if (a.is_leaf() && b.is_leaf()) {
            leaves.push_back(at);
            continue;
        }
        const auto children = children_of(at, a, b, walk.separation);
        for (const NodePair& child : {children[1], children[0]}) {
            walk.waiting.push_if(child,
                                 !walk.separation.apart(walk.nodes_a[child.a], walk.nodes_b[child.b], walk.reach));
        }
    }
    return leaves;
}

TEST(MeshWalk, FindsTheLeavesThatSeparationFinds) {
    Couple couple(torus_mesh({20, 12, 0.3, 1}), sphere_mesh(0.8, 2));
    RandomStream random(11, 0);
    std::size_t all = 0;
    for (int round = 0; round < 60; ++round) {
        couple.pose_a = random_pose(random, 2);
        couple.pose_b = random_pose(random, 2);
        if (round % 3 == 1) scale(couple.pose_b, {1, 0, 1});  // cannot be inverted: compared along the world's axes
        const float reach = float(round % 4) * 0.1F;
        MeshWalk walk(couple.a(), couple.b(), reach);
        std::vector<NodePair> found;
        std::array<NodePair, 7> some;
        for (unsigned count = 7; count == 7;) {
            count = next_leaves(walk, some);
            found.insert(found.end(), some.begin(), some.begin() + count);
        }
        const auto numbers = [](const NodePair& leaf) { return std::pair(leaf.a, leaf.b); };
        EXPECT_TRUE(std::ranges::equal(found, leaves_within({couple.a(), couple.b(), reach}), {}, numbers, numbers))
            << round;
        all += found.size();
    }
    EXPECT_GT(all, 10'000u);
}

TEST(MeshPair, GapIsTheLeastOfAllTriangles) {
    Couple couple(torus_mesh({12, 8, 0.2, 3}), torus_mesh({9, 7, 0.2, 4}));
    RandomStream random(8, 0);
    for (int round = 0; round < 20; ++round) {
        couple.pose_a = random_pose(random, 3);
        couple.pose_b = random_pose(random, 3);
        if (round % 3 == 1) scale(couple.pose_b, {1, -2, 0.25});
        const double least = couple.min_gap();
        const auto gap = surface_gap(couple.a(), couple.b(), 100);
        ASSERT_TRUE(gap);
        EXPECT_EQ(gap->distance, least);
        EXPECT_EQ(surface_gap(couple.a(), couple.b(), least)->distance, least);
        if (least > 0) {
            EXPECT_FALSE(surface_gap(couple.a(), couple.b(), std::nextafter(least, 0.0)));
        }
    }
}

TEST(MeshPair, TouchingCounts) {
    Couple boxes(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({1, 1, 1}, {2, 2, 2}));
    EXPECT_TRUE(surfaces_meet(boxes.a(), boxes.b()));  // at a corner
    move(boxes.pose_b, 0x1p-52);
    EXPECT_FALSE(surfaces_meet(boxes.a(), boxes.b()));
    boxes.expect_as_by_all_pairs();

    // With equal poses, rounding moves the common corner to the same place in both meshes.
    RandomStream random(9, 0);
    for (int round = 0; round < 200; ++round) {
        boxes.pose_a = boxes.pose_b = random_pose(random, 1000);
        EXPECT_TRUE(surfaces_meet(boxes.a(), boxes.b()));
    }
}

TEST(MeshPair, MeshesOnTopOfEachOtherMeet) {
    Couple same(torus_mesh({10, 8, 0.1, 1}), torus_mesh({10, 8, 0.1, 1}));
    same.expect_as_by_all_pairs();
    RandomStream random(10, 0);
    same.pose_a = same.pose_b = random_pose(random, 1e6);
    EXPECT_TRUE(surfaces_meet(same.a(), same.b()));
    EXPECT_GE(same.visited().size(), same.mesh_a.triangles.size());
}

TEST(MeshPair, EmptyAndDegenerateMeshes) {
    Couple couple({}, box_mesh({0, 0, 0}, {1, 1, 1}));
    EXPECT_FALSE(surfaces_meet(couple.a(), couple.b()));
    EXPECT_FALSE(surface_gap(couple.a(), couple.b(), 10));
    EXPECT_FALSE(encloses_part(couple.b(), couple.a()));

    // All triangles are at one point, so the tree cannot separate them.
    shape::Mesh points;
    for (int i = 0; i < 1000; ++i) points.vertices.push_back({0.5, 0.5, i < 999 ? 1.0 : 3.0});
    for (std::uint32_t i = 0; i < 998; ++i) points.triangles.push_back({i, i + 1, 0});
    Couple at_point(points, box_mesh({0, 0, 0}, {1, 1, 1}));
    EXPECT_EQ(at_point.visited().size(), at_point.all_meeting().size());
    EXPECT_EQ(at_point.visited().size(), 998u * 2);  // the point is on the diagonal of the top, between two triangles
}

TEST(MeshPair, HugeAndTinyNumbers) {
    Couple couple(sphere_mesh(1, 1), sphere_mesh(1, 1));
    for (const double size : {1e-300, 1e-150, 1e150, 1e300}) {
        couple.pose_a = couple.pose_b = Pose{};
        scale(couple.pose_a, {size, size, size});
        scale(couple.pose_b, {size, size, size});
        couple.pose_b.rows[0][3] = size * 1.5;
        couple.expect_as_by_all_pairs();
        EXPECT_TRUE(surfaces_meet(couple.a(), couple.b())) << size;
    }
}

/// Returns whether `outer` encloses each of the places at the given distances from the origin along a diagonal.
std::vector<bool> enclosed(const shape::Mesh& outer, const Pose& pose, std::initializer_list<double> distances) {
    const auto tree = make_mesh_tree(outer);
    std::vector<bool> inside;
    for (const double d : distances) inside.push_back(encloses({*tree, pose}, vector::posed(pose, {d, d / 3, d / 7})));
    return inside;
}

shape::Mesh joined(shape::Mesh a, const shape::Mesh& b) {
    const auto first = std::uint32_t(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const auto& [p, q, r] : b.triangles) a.triangles.push_back({p + first, q + first, r + first});
    return a;
}

shape::Mesh turned_over(shape::Mesh mesh) {
    for (auto& corners : mesh.triangles) std::swap(corners[1], corners[2]);
    return mesh;
}

TEST(MeshInside, ClosedMeshesEnclose) {
    using Answers = std::vector<bool>;
    const shape::Mesh ball = sphere_mesh(1, 3), core = sphere_mesh(0.5, 2);
    RandomStream random(11, 0);
    Pose mirrored = random_pose(random, 1e6);
    scale(mirrored, {-1, 1, 2});
    for (const Pose& pose : {Pose{}, random_pose(random, 100), mirrored}) {
        EXPECT_EQ(enclosed(ball, pose, {0, 0.7, 1.5}), (Answers{true, true, false}));
        EXPECT_EQ(enclosed(turned_over(ball), pose, {0, 0.7, 1.5}), (Answers{true, true, false}));
        // First a hollow ball, then a mesh of two solids, one inside the other.
        EXPECT_EQ(enclosed(joined(ball, turned_over(core)), pose, {0, 0.7, 1.5}), (Answers{false, true, false}));
        EXPECT_EQ(enclosed(joined(ball, core), pose, {0, 0.7, 1.5}), (Answers{true, true, false}));
        shape::Mesh open = ball;
        open.triangles.pop_back();
        EXPECT_EQ(enclosed(open, pose, {0, 0.7, 1.5}), (Answers{false, false, false}));
        shape::Mesh unsure = ball;
        std::swap(unsure.triangles[5][0], unsure.triangles[5][1]);
        EXPECT_EQ(enclosed(unsure, pose, {0, 0.7, 1.5}), (Answers{true, true, false}));
    }
}

TEST(MeshInside, CornersOfTriangleSoupsCloseThem) {
    const shape::Mesh box = box_mesh({0, 0, 0}, {1, 1, 1});
    shape::Mesh soup;
    for (const auto& corners : box.triangles) {
        const auto first = std::uint32_t(soup.vertices.size());
        for (const std::uint32_t corner : corners) soup.vertices.push_back(box.vertices[corner]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    // Along x the ray passes through edges and corners of the box.
    const auto tree = make_mesh_tree(soup);
    for (const double y : {0.25, 0.5, 0.75}) EXPECT_TRUE(encloses({*tree, Pose{}}, {0.5, y, y}));
    for (const double y : {-0.5, 0.0, 1.0, 1.5}) EXPECT_FALSE(encloses({*tree, Pose{}}, {-0.5, y, y})) << y;
}

TEST(MeshInside, InsideMeansWhollyInside) {
    const auto cube = [](double half) { return box_mesh({-half, -half, -half}, {half, half, half}); };
    Couple boxes(cube(2), cube(1));
    EXPECT_TRUE(contains_mesh(boxes.a(), boxes.b()));
    EXPECT_FALSE(contains_mesh(boxes.b(), boxes.a()));
    // The surface of b is inside the wall of a hollow cube and surrounds the hollow.
    shape::Mesh hollow = cube(1.5);
    for (auto& corners : hollow.triangles) std::swap(corners[0], corners[1]);
    Couple around(joined(cube(2), hollow), cube(1.75));
    EXPECT_TRUE(encloses_part(around.a(), around.b()));
    EXPECT_FALSE(contains_mesh(around.a(), around.b()));
    EXPECT_FALSE(contains_mesh(around.b(), around.a()));
    Couple nothing(cube(2), {});
    EXPECT_FALSE(contains_mesh(nothing.a(), nothing.b()));
}

TEST(MeshInside, PartsAreJudgedOneByOne) {
    Couple couple(box_mesh({0, 0, 0}, {10, 10, 10}),
                  joined(box_mesh({20, 0, 0}, {21, 1, 1}), box_mesh({4, 4, 4}, {5, 5, 5})));
    EXPECT_FALSE(surfaces_meet(couple.a(), couple.b()));
    EXPECT_TRUE(encloses_part(couple.a(), couple.b()));
    EXPECT_FALSE(encloses_part(couple.b(), couple.a()));
    EXPECT_FALSE(contains_mesh(couple.a(), couple.b()));
    couple.pose_b.rows[0][3] = 7;
    EXPECT_FALSE(encloses_part(couple.a(), couple.b()));
    EXPECT_FALSE(contains_mesh(couple.a(), couple.b()));
}

}  // namespace
}  // namespace octopair::test
