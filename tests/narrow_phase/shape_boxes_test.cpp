// Tests the boxes of shapes: they contain the shape, are no larger than necessary, and invalid objects are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "narrow_phase/convex_oracle.hpp"
#include "narrow_phase/motion/motion.hpp"
#include "narrow_phase/plane_pair.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/error.hpp"
#include "samples/meshes.hpp"
#include "samples/random.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

using samples::random_pose;
using samples::RandomStream;

/// Objects that own their arrays.
struct Made {
    std::vector<Geometry> geometries;
    std::vector<std::uint32_t> geometry;
    std::vector<Pose> poses, end_poses;

    void add(shape::Any shape, const Pose& pose) {
        geometry.push_back(std::uint32_t(geometries.size()));
        geometries.emplace_back(std::move(shape));
        poses.push_back(pose);
    }
    ShapedObjects all() const { return {geometries, geometry, poses, end_poses, {}}; }
};

std::string refusal(const Made& made) {
    return error_if_any(ErrorCode::bad_input, [&] { check(made.all()); });
}
std::string refusal(const shape::Any& shape) {
    return error_if_any(ErrorCode::bad_input, [&] { const Geometry geometry(shape); });
}

Box3d box_by_all(const shape::Mesh& mesh, const Pose& pose) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box3d box = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const Point3d& vertex : mesh.vertices) {
        const Point3d at = vector::posed(pose, vertex);
        for (std::size_t k = 0; k < 3; ++k) {
            box.min[k] = std::min(box.min[k], at[k]), box.max[k] = std::max(box.max[k], at[k]);
        }
    }
    return box;
}

bool holds(const Box3d& box, const Point3d& point) {
    bool all = true;
    for (std::size_t k = 0; k < 3; ++k) all &= box.min[k] <= point[k] && point[k] <= box.max[k];
    return all;
}

std::vector<shape::Any> primitives() {
    return {shape::Sphere{0.5},
            shape::Box{{0.5, 1, 2}},
            shape::Capsule{0.25, 2},
            shape::Cylinder{0.5, 2},
            shape::Cone{0.5, 2},
            shape::Ellipsoid{{0.5, 1, 2}},
            shape::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}}};
}

TEST(ShapeBoxes, OfMeshesAreThoseOfAllVertices) {
    RandomStream random(1, 0);
    for (const shape::Mesh& mesh : {samples::torus_mesh({40, 30, 0.3}), samples::sphere_mesh(1e-3, 2)}) {
        Made made;
        for (int i = 0; i < 60; ++i) {
            Pose pose = random_pose(random, i % 2 ? 1e6 : 1);
            for (auto& number : pose.rows[std::size_t(i) % 3]) number *= i % 3 ? 1 : -2;
            made.add(mesh, pose);
        }
        const std::vector<Box3d> boxes = boxes_of(made.all());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Box3d all = box_by_all(mesh, made.poses[i]);
            for (int k = 0; k < 3; ++k) {
                EXPECT_EQ(boxes[i].min[k], all.min[k]);
                EXPECT_EQ(boxes[i].max[k], all.max[k]);
            }
        }
    }
}

TEST(ShapeBoxes, OfPrimitivesFitTightly) {
    RandomStream random(2, 0);
    for (const shape::Any& shape : primitives()) {
        Made made;
        made.add(shape, random_pose(random, 10));
        const PosedShape posed = {shape, made.poses[0]};
        const Box3d box = boxes_of(made.all())[0];
        for (int k = 0; k < 3; ++k) {
            for (const double side : {-1e5, 1e5}) {
                Point3d far = vector::place(posed.pose);
                far[std::size_t(k)] += side;
                const Point3d outermost = nearest_in(posed, far);
                EXPECT_TRUE(holds(box, outermost));
                EXPECT_NEAR(side < 0 ? box.min[k] : box.max[k], outermost[std::size_t(k)], 1e-4);
            }
        }
    }
}

TEST(ShapeBoxes, OfMovingObjectsHoldTheWholeWay) {
    RandomStream random(3, 0);
    std::vector<shape::Any> shapes = primitives();
    shapes.emplace_back(samples::box_mesh({1, 1, 1}, {2, 3, 4}));
    for (const shape::Any& shape : shapes) {
        Made made;
        made.add(shape, random_pose(random, 3));
        made.end_poses.push_back(random_pose(random, 3));
        const Box3d box = boxes_of(made.all())[0];
        const auto motion = Motion::between(made.poses[0], made.end_poses[0]);
        ASSERT_TRUE(motion);
        EXPECT_EQ(motion->at(0).rows, made.poses[0].rows);
        EXPECT_EQ(motion->at(1).rows, made.end_poses[0].rows);
        double over = 0;
        for (int step = 0; step <= 200; ++step) {
            made.poses[0] = motion->at(step / 200.0);
            Made still = made;
            still.end_poses.clear();
            const Box3d now = boxes_of(still.all())[0];
            for (int k = 0; k < 3; ++k) {
                EXPECT_LE(box.min[k], now.min[k]);
                EXPECT_GE(box.max[k], now.max[k]);
                over = std::max(over, now.max[k] - now.min[k]);
            }
        }
        EXPECT_LT(box.max[0] - box.min[0], over + 9);
    }
}

TEST(ShapeBoxes, PlanesReachAllOthers) {
    Made made;
    made.add(shape::Sphere{1}, make_pose({0, 0, 5}));
    made.add(shape::Sphere{1}, make_pose({10, 0, 5}));
    made.add(shape::Plane{{0, 0, 2}, 4}, Pose{});
    made.add(shape::Plane{{1, 0, 1}, 0}, Pose{});
    const std::vector<Box3d> boxes = boxes_of(made.all());
    // A plane across an axis has a thin box, as wide as the boxes of other objects.
    EXPECT_NEAR(boxes[2].min[2], 2, 1e-12);
    EXPECT_LT(boxes[2].max[2] - boxes[2].min[2], 1e-12);
    EXPECT_LE(boxes[2].min[0], -1);
    EXPECT_GE(boxes[2].max[0], 11);
    // An oblique plane has the bounds of the other objects.
    EXPECT_EQ(boxes[3].min[2], boxes[0].min[2]);
    EXPECT_EQ(boxes[3].max[0], boxes[1].max[0]);
    Made second;
    second.add(shape::Sphere{1}, make_pose({0, 50, 5}));
    EXPECT_GE(boxes_of(made.all(), second.all()).first[2].max[1], 51);
}

TEST(ShapeBoxes, PlanesAgainstSolids) {
    RandomStream random(4, 0);
    for (const shape::Any& shape : primitives()) {
        for (int i = 0; i < 40; ++i) {
            const shape::Plane flat = {{random.gaussian(), random.gaussian(), random.gaussian()}, random.gaussian()};
            const PosedShape thing = {shape, random_pose(random, 2)}, surface = {flat, random_pose(random, 2)};
            const ConvexSolid solid = make_convex_solid(shape);
            const PosedPlane plane = posed_plane(flat, surface.pose);
            const PlaneSpan span = span_across(plane, PosedConvex(solid, thing.pose));
            const double oracle = distance_by_turns(surface, thing, 200);
            const ConvexGap gap = plane_gap(plane, span);
            EXPECT_LE(gap.at_least, oracle + 1e-12);
            EXPECT_EQ(meets(span), gap.distance == 0);
            // The nearest points lie on the plane and on the shape, so the distance is not too short either.
            EXPECT_LT(vector::length(vector::minus(nearest_in(surface, gap.on_a), gap.on_a)), 1e-9);
            EXPECT_LT(vector::length(vector::minus(nearest_in(thing, gap.on_b), gap.on_b)), 1e-9);
            EXPECT_NEAR(gap.at_least, gap.distance, 1e-12);
            if (!meets(span)) {
                EXPECT_NEAR(vector::length(vector::minus(gap.on_b, gap.on_a)), gap.distance, 1e-9);
                continue;
            }
            const ConvexContact contact = plane_contact(plane, span);
            Pose parted = thing.pose;
            for (std::size_t k = 0; k < 3; ++k) parted.rows[k][3] += contact.normal[k] * (contact.depth + 1e-9);
            EXPECT_FALSE(meets(span_across(plane, PosedConvex(solid, parted))));
        }
    }
}

TEST(ShapeBoxes, BadShapesAndObjectsAreNamed) {
    EXPECT_TRUE(has_text(refusal(shape::Sphere{0}), "radius"));
    EXPECT_TRUE(has_text(refusal(shape::Box{{1, NAN, 1}}), "along y"));
    EXPECT_TRUE(has_text(refusal(shape::Ellipsoid{{1, 1, 1e-310}}), "along z is below 2.3e-308"));
    EXPECT_TRUE(has_text(refusal(shape::Capsule{1, -1}), "length"));
    EXPECT_TRUE(has_text(refusal(shape::Plane{{0, 0, 0}, 1}), "normal"));
    EXPECT_TRUE(has_text(refusal(shape::ConvexHull{}), "no points"));
    EXPECT_TRUE(has_text(refusal(shape::Mesh{{{0, 0, 0}}, {{{0, 0, 1}}}}), "triangle 0"));
    EXPECT_TRUE(has_text(refusal(shape::Mesh{{{0, 0, INFINITY}}, {}}), "vertex 0"));
    EXPECT_EQ(refusal(shape::Mesh{}), "");
    Made made;
    made.add(shape::Sphere{1}, Pose{});
    EXPECT_EQ(refusal(made), "");
    made.poses[0].rows[0][0] = -1;
    EXPECT_TRUE(has_text(refusal(made), "object 0"));
    made.poses[0].rows[0][0] = NAN;
    EXPECT_TRUE(has_text(refusal(made), "not finite"));
    made.poses[0] = Pose{};
    made.poses[0].rows[1][3] = -1e308;
    EXPECT_TRUE(has_text(refusal(made), "object 0 brings it beyond 1.1e307"));
    made.poses[0] = Pose{};
    made.geometry[0] = 7;
    EXPECT_TRUE(has_text(refusal(made), "geometry 7 of 1"));
    made.geometry[0] = 0;
    made.end_poses.resize(2);
    EXPECT_TRUE(has_text(refusal(made), "end poses"));
}

TEST(ShapedObjects, MotionsMustBeRigidAndPlanesDoNotTurn) {
    const Pose place{}, turned = make_pose({1, 2, 3}, {0.8, 0.6, 0, 0});
    Pose mirrored = place;
    mirrored.rows[0][0] = -1;
    Made made;
    made.add(shape::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, place);
    made.end_poses = {turned};
    EXPECT_EQ(refusal(made), "");
    made.end_poses = {mirrored};
    EXPECT_EQ(refusal(made), "object 0: no rotation and translation leads from its pose to its end pose");
    made.add(shape::Plane{{1, 0, 0}, 0}, place);
    made.end_poses = {turned, place};
    EXPECT_EQ(refusal(made), "");
    made.end_poses[1] = turned;
    EXPECT_EQ(refusal(made), "object 1 is a plane that rotates; planes may only be moved");
}

TEST(ShapedObjects, PaddingsAreFiniteAndNotBelowZero) {
    Made made;
    made.add(shape::Sphere{1}, {});
    for (const double wrong : {-1.0, double(NAN), double(INFINITY)}) {
        const std::vector<double> padding = {wrong};
        ShapedObjects objects = made.all();
        objects.padding = padding;
        EXPECT_THROW(check(objects), Error) << wrong;
    }
}

TEST(Geometry, PlanesHaveOffsetsThatFloat64Holds) {
    EXPECT_EQ(refusal(shape::Plane{{0, 0, 1}, 1e300}), "");
    EXPECT_EQ(refusal(shape::Plane{{0, 0, 1}, NAN}), "a plane's offset is not finite: nan");
    EXPECT_TRUE(has_text(refusal(shape::Plane{{0, 0, 1e-100}, 1e300}), "it is beyond float64"));
}

}  // namespace
}  // namespace octopair::test
