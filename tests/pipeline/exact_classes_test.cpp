// Tests classes and depths of the exact filters: tolerance, duplicates, meshes with gaps, and shapes that touch by construction.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "octopair/error.hpp"
#include "pipeline/exact_scene.hpp"
#include "samples/random.hpp"

namespace octopair::test {
namespace {

using samples::RandomStream;

TEST(ExactClasses, DuplicatesHaveATolerance) {
    constexpr double apart = 0x1p-10;
    const std::vector<shape::Any> shapes = {box_mesh({0, 0, 0}, {1, 2, 3}), shape::Box{{1, 2, 3}},
                                            shape::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    for (const shape::Any& shape : shapes) {
        Scene scene;
        scene.add(shape);
        scene.add(shape, make_pose({apart, 0, 0}));
        EXPECT_EQ(collision_of(scene).collision_class, CollisionClass::penetrating);
        EXPECT_EQ(collision_of(scene, {.tolerance = apart}).collision_class, CollisionClass::duplicate);
        EXPECT_EQ(collision_of(scene, {.tolerance = apart, .duplicate_tolerance = 0}).collision_class,
                  CollisionClass::penetrating);
        EXPECT_EQ(collision_of(scene, {.duplicate_tolerance = apart}).collision_class, CollisionClass::duplicate);
    }
    // Equal meshes of other divisions are not the same geometry; equal poses of other sizes are not either.
    Scene others;
    others.add(shape::Box{{1, 1, 1}});
    others.add(shape::Box{{1, 1, 1.5}});
    EXPECT_EQ(collision_of(others, {.tolerance = 0.4}).collision_class, CollisionClass::penetrating);
    EXPECT_THROW((void)collision_of(others, {.duplicate_tolerance = -1}), Error);
    EXPECT_THROW((void)collision_of(others, {.tolerance = std::numeric_limits<double>::infinity()}), Error);
}

TEST(ExactClasses, MeshesThatTouchAfterQuarterTurns) {
    // Rotations whose coefficients are integers after the division; of any length of the quaternion.
    const std::vector<std::array<double, 4>> turns = {{1, 1, 0, 0}, {1, 0, 1, 0}, {0, 0, 3, 3}, {0, 1, 1, 0},
                                                      {1, 1, 1, 1}, {3, 3, 3, 3}, {5, 0, 0, 5}, {0.7, 0.7, 0, 0}};
    for (const auto& turn : turns) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (const double sense : {2.0, -2.0}) {
                Scene scene;
                Point3d place = {};
                place[axis] = sense;
                scene.add(box_mesh({-1, -1, -1}, {1, 1, 1}), make_pose({0, 0, 0}, turn));
                scene.add(box_mesh({-1, -1, -1}, {1, 1, 1}), make_pose(place));
                EXPECT_EQ(collision_of(scene).collision_class, CollisionClass::touching);
            }
        }
    }
}

TEST(ExactClasses, MeshesThatAreConvexButForRounding) {
    RandomStream random(17, 0);
    for (int i = 0; i < 100; ++i) {
        const Pose turn = samples::random_pose(random, 0.5);
        shape::Mesh mesh = box_mesh({-1, -0.7, -0.4}, {1, 0.7, 0.4});
        for (Point3d& vertex : mesh.vertices) {
            vertex = vector::posed(turn, vertex);
            if (i % 2 == 0) continue;
            for (double& at : vertex) at = double(float(at));  // as in files of float32
        }
        Scene baked, posed;
        baked.add(mesh);
        posed.add(shape::Box{{1, 0.7, 0.4}}, turn);
        for (Scene* scene : {&baked, &posed}) scene->add(shape::Box{{0.5, 0.5, 0.5}}, make_pose({0.2, 0.3, 0.1}));
        const Finding found = collision_of(baked), expected = collision_of(posed);
        EXPECT_EQ(found.collision_class, expected.collision_class);
        EXPECT_EQ(found.depth_kind, DepthKind::least);
        EXPECT_NEAR(found.depth, expected.depth, 1e-6);
    }
}

TEST(ExactClasses, TurnedCurvedShapesThatTouch) {
    // Cylinders and cones stand on boxes, lie on them, or touch them with their tips, in rotations by integer quaternions.
    RandomStream random(16, 0);
    const auto digit = [&](int most) { return double(random.below(unsigned(2 * most + 1))) - most; };
    for (int i = 0; i < 2000 && !::testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE("pair " + std::to_string(i));
        const double radius = 1 + double(random.below(4)), half = 1 + double(random.below(4));
        const bool cone = random.below(3) == 0, lies = !cone && random.below(2) == 0;
        const shape::Any above =
            cone ? shape::Any(shape::Cone{radius, 2 * half}) : shape::Any(shape::Cylinder{radius, 2 * half});
        const double up = lies ? radius : half;
        const Point3d place = {digit(2), digit(2), up};
        const Pose lying = make_pose(place, {1, 1, 0, 0});
        const Pose turn =
            make_pose({digit(3), digit(3), digit(3)}, {1 + double(random.below(3)), digit(3), digit(3), digit(3)});
        const auto turned = [&](const Pose& pose) {
            Pose both;
            for (std::size_t row = 0; row < 3; ++row) {
                for (std::size_t column = 0; column < 4; ++column) {
                    double sum = column == 3 ? turn.rows[row][3] : 0;
                    for (std::size_t k = 0; k < 3; ++k) sum += turn.rows[row][k] * pose.rows[k][column];
                    both.rows[row][column] = sum;
                }
            }
            return both;
        };
        const auto finding = [&](double deep) {
            Scene scene;
            scene.add(shape::Box{{3, 3, 2}}, turned(make_pose({0, 0, -2 + deep})));
            scene.add(above, turned(lies ? lying : make_pose(place)));
            const std::vector<Collision> found = find(scene);
            return found.empty() ? Finding{} : found[0].finding;
        };
        // Rounding may leave a gap between shapes that touch.
        EXPECT_NE(finding(0).collision_class, CollisionClass::penetrating);
        const Finding deep = finding(0.5);
        EXPECT_EQ(deep.collision_class, CollisionClass::penetrating);
        EXPECT_NEAR(deep.depth, 0.5, 1e-9);
    }
}

TEST(ExactClasses, AMeshOfABoxIsLikeTheBox) {
    // The other object is a box, a mesh, a ball, or a flat hull that passes through.
    const std::vector<shape::Any> others = {shape::Box{{1, 1, 1}}, box_mesh({-1, -1, -1}, {1, 1, 1}), shape::Sphere{1},
                                            shape::ConvexHull{{{-3, 0.1, 0.2}, {2, 0.1, 0.2}}},
                                            shape::ConvexHull{{{-3, 0, 0}, {2, 0, 0}}}};
    for (const shape::Any& other : others) {
        for (const Point3d& place : {Point3d{0.5, 0.25, 0.125}, Point3d{1.5, 0.25, 0.125}, Point3d{2, 0.25, 0.125}}) {
            std::array<Finding, 2> found;
            for (const std::size_t i : {0U, 1U}) {
                Scene scene;
                const shape::Any mesh = box_mesh({-1, -1, -1}, {1, 1, 1}), box = shape::Box{{1, 1, 1}};
                scene.add(i == 0 ? mesh : box);
                scene.add(other, make_pose(place));
                found[i] = collision_of(scene);
            }
            EXPECT_EQ(found[0].collision_class, found[1].collision_class);
            EXPECT_NEAR(found[0].depth, found[1].depth, 1e-12);
            EXPECT_EQ(found[0].depth_kind, found[1].depth_kind);
        }
    }
}

TEST(ExactClasses, ToleranceNeedsAMotionThatSeparatesOrAThinOverlap) {
    // Walls of a mesh that is not convex, and a box in the gap between them, T deep in one wall or in both.
    constexpr double tolerance = 0x1p-10;
    shape::Mesh walls = box_mesh({0, 0, 0}, {1, 4, 4});
    const shape::Mesh other_wall = box_mesh({3, 0, 0}, {4, 4, 4});
    for (const auto& triangle : other_wall.triangles) {
        walls.triangles.push_back({triangle[0] + 8, triangle[1] + 8, triangle[2] + 8});
    }
    walls.vertices.insert(walls.vertices.end(), other_wall.vertices.begin(), other_wall.vertices.end());
    const auto class_at = [&](double begin, double end, bool mesh) {
        Scene scene;
        scene.add(walls);
        const shape::Any between = mesh ? shape::Any(box_mesh({begin, 1, 1}, {end, 2, 2}))
                                        : shape::Any(shape::Box{{(end - begin) / 2, 0.5, 0.5}});
        scene.add(between, mesh ? Pose{} : make_pose({(begin + end) / 2, 1.5, 1.5}));
        return collision_of(scene, {.tolerance = tolerance}).collision_class;
    };
    for (const bool mesh : {false, true}) {
        EXPECT_EQ(class_at(1, 3, mesh), CollisionClass::touching);
        EXPECT_EQ(class_at(1 - tolerance, 2.5, mesh), CollisionClass::touching);
        EXPECT_EQ(class_at(1 - 2 * tolerance, 2.5, mesh), CollisionClass::penetrating);
        // A motion out of one wall leads into the other, but the overlaps are thin.
        EXPECT_EQ(class_at(1 - tolerance, 3 + tolerance, mesh), CollisionClass::touching);
        EXPECT_EQ(class_at(1 - 2 * tolerance, 3 + 2 * tolerance, mesh), CollisionClass::penetrating);
    }
}

TEST(ExactClasses, MeshesWithGapsSayThatTheyAreOpen) {
    shape::Mesh cube = box_mesh({-1, -1, -1}, {1, 1, 1});
    cube.vertices.push_back(cube.vertices[0]);
    cube.vertices.back()[0] += 0x1p-40;
    cube.triangles[0][0] = cube.triangles[0][0] == 0 ? 8 : cube.triangles[0][0];
    cube.triangles[0][1] = cube.triangles[0][1] == 0 ? 8 : cube.triangles[0][1];
    cube.triangles[0][2] = cube.triangles[0][2] == 0 ? 8 : cube.triangles[0][2];
    EXPECT_FALSE(Geometry(cube).closed());
    Scene scene;
    scene.add(cube);
    scene.add(shape::Sphere{0.25});
    scene.add(shape::Sphere{0.25}, make_pose({1, 0, 0}));
    const std::vector<Collision> open = find(scene);
    ASSERT_EQ(open.size(), 1u);  // the ball inside is no collision, because there is no inside
    EXPECT_EQ(open[0].finding.open, (std::array<bool, 2>{true, false}));
    for (const double tolerance : {0.0, 0x1p-42}) {
        shape::Mesh too_little = cube;
        weld(too_little, tolerance);
        EXPECT_FALSE(Geometry(too_little).closed());
    }
    weld(cube, 0x1p-39);
    EXPECT_TRUE(Geometry(cube).closed());
    Scene welded;
    welded.add(cube);
    welded.add(shape::Sphere{0.25});
    EXPECT_EQ(collision_of(welded).collision_class, CollisionClass::contained);
    EXPECT_THROW(weld(cube, -1), Error);
    // A closed mesh has no gap: no tolerance changes it.
    shape::Mesh closed = box_mesh({0, 0, 0}, {10, 10, 0.5});
    const auto before = closed.triangles;
    weld(closed, 100);
    EXPECT_EQ(closed.triangles, before);
}

TEST(ExactClasses, DepthsBelowTheMinimumAreLeftOut) {
    const Scene scene = two_boxes({1, 1, 1}, {1, 1, 1}, {0.75, 0.1, 0.2});
    for (const auto& [least, count] : {std::pair(0.25, 1U), std::pair(0.2500001, 0U)}) {
        Pipeline pipeline(1);
        pipeline.add(make_exact_object_filter(scene.objects()));
        pipeline.add(make_exact_feature_filter(scene.objects()));
        pipeline.add(make_depth_filter(least));
        const std::vector<Box3d> boxes = boxes_of(scene.objects());
        const PipelineSummary summary = pipeline.run(*make_local_engine(1), Objects{boxes}, {});
        EXPECT_EQ(summary.collisions, count);
        EXPECT_EQ(summary.of_class[std::size_t(CollisionClass::penetrating)], count);
    }
}

}  // namespace
}  // namespace octopair::test
