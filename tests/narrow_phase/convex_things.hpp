// Convex shapes of all kinds with their poses, for tests of pairs.
#pragma once

#include <gtest/gtest.h>

#include <utility>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/convex_oracle.hpp"
#include "samples/random.hpp"

namespace octopair::test {

inline constexpr int kinds = 7;  // of random_shape()

inline Point3d random_point(samples::RandomStream& random) {
    return {random.gaussian(), random.gaussian(), random.gaussian()};
}

inline shape::Any random_shape(int kind, samples::RandomStream& random) {
    const auto length = [&] { return random.uniform(0.1, 1.1); };
    switch (kind) {
        case 0:
            return shape::Sphere{length()};
        case 1:
            return shape::Box{{length(), length(), length()}};
        case 2:
            return shape::Capsule{length(), length() - 0.1};
        case 3:
            return shape::Cylinder{length(), length()};
        case 4:
            return shape::Cone{length(), length()};
        case 5:
            return shape::Ellipsoid{{length(), length(), length()}};
        default:
            break;
    }
    shape::ConvexHull hull;
    const auto count = 1 + random.below(7);
    for (std::uint64_t i = 0; i < count; ++i) hull.points.push_back(vector::times(random_point(random), 0.6));
    return hull;
}

/// A shape with its solid and its pose.
struct Thing {
    PosedShape posed;
    ConvexSolid solid;

    Thing(shape::Any shape, const Pose& pose) : posed{std::move(shape), pose}, solid(make_convex_solid(posed.shape)) {}
    explicit Thing(shape::Any shape, const Point3d& place = {0, 0, 0}) : Thing(std::move(shape), make_pose(place)) {}

    PosedConvex convex() const { return {solid, posed.pose}; }
    Thing moved(const Point3d& by) const {
        Pose pose = posed.pose;
        for (std::size_t axis = 0; axis < 3; ++axis) pose.rows[axis][3] += by[axis];
        return {posed.shape, pose};
    }
    double off(const Point3d& point) const { return vector::length(vector::minus(nearest_in(posed, point), point)); }
};

inline bool meet(const Thing& a, const Thing& b) {
    const bool answer = convex_meet(a.convex(), b.convex());
    EXPECT_EQ(convex_meet(b.convex(), a.convex()), answer);
    return answer;
}
inline double gap(const Thing& a, const Thing& b) { return convex_gap(a.convex(), b.convex()).distance; }
inline ConvexContact contact(const Thing& a, const Thing& b) { return convex_contact(a.convex(), b.convex()); }

}  // namespace octopair::test
