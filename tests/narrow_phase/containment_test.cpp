// Tests which convex shapes contain which others, near the border between both answers: every kind in every kind.
//
// Border  The oracle finds the point of the inner shape that is farthest out, as a multiple of the outer shape: by a dense search and its
//         refinement, with formulas of its own. Scaled by the inverse of this multiple, the inner shape touches the surface from inside.
//         A shape that is larger has a point outside, which is a proof; the proof that a smaller one has none is the search's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_pair.hpp"
#include "samples/meshes.hpp"
#include "samples/random.hpp"
#include "support/cases.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using samples::RandomStream;

enum class Nestable { sphere, box, capsule, cylinder, cone, ellipsoid, box_hull, octahedron };
constexpr int kind_count = 8;

shape::ConvexHull hull_of_box(const Point3d& half) {
    shape::ConvexHull hull;
    for (int i = 0; i < 8; ++i) {
        hull.points.push_back({(i & 1 ? 1 : -1) * half[0], (i & 2 ? 1 : -1) * half[1], (i & 4 ? 1 : -1) * half[2]});
    }
    return hull;
}

shape::ConvexHull octahedron(const Point3d& half) {
    shape::ConvexHull hull;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
            Point3d corner = {};
            corner[axis] = sign * half[axis];
            hull.points.push_back(corner);
        }
    }
    return hull;
}

/// A shape of a kind with three lengths. A sphere uses the first one; a capsule, a cylinder and a cone use the first and the third.
struct Model {
    Nestable kind;
    Point3d size;

    shape::Any shape() const {
        switch (kind) {
            case Nestable::sphere:
                return shape::Sphere{size[0]};
            case Nestable::box:
                return shape::Box{size};
            case Nestable::capsule:
                return shape::Capsule{size[0], 2 * size[2]};
            case Nestable::cylinder:
                return shape::Cylinder{size[0], 2 * size[2]};
            case Nestable::cone:
                return shape::Cone{size[0], 2 * size[2]};
            case Nestable::ellipsoid:
                return shape::Ellipsoid{size};
            case Nestable::box_hull:
                return hull_of_box(size);
            case Nestable::octahedron:
                break;
        }
        return octahedron(size);
    }

    Model scaled(double by) const { return {kind, vector::times(size, by)}; }

    /// Returns the multiple of the shape, scaled around its origin, on whose surface a point lies.
    double multiple_at(const Point3d& at) const {
        const double across = std::hypot(at[0], at[1]), along = std::fabs(at[2]);
        const auto part = [&](std::size_t axis) { return std::fabs(at[axis]) / size[axis]; };
        switch (kind) {
            case Nestable::sphere:
                return vector::length(at) / size[0];
            case Nestable::box:
            case Nestable::box_hull:
                return std::max({part(0), part(1), part(2)});
            case Nestable::cylinder:
                return std::max(across / size[0], part(2));
            case Nestable::cone:
                // The wall is at radius (1 - z / half) radius / 2.
                return std::max(2 * across / size[0] + at[2] / size[2], -at[2] / size[2]);
            case Nestable::ellipsoid:
                return std::hypot(part(0), part(1), part(2));
            case Nestable::octahedron:
                return part(0) + part(1) + part(2);
            case Nestable::capsule:
                break;
        }
        const double radius = size[0], half = size[2];
        if (along * radius <= half * across) return across / radius;
        // The least positive root of (along - t half)^2 + across^2 = (t radius)^2.
        const double square = half * half - radius * radius, product = along * half,
                     rest = along * along + across * across;
        const double root = std::sqrt(std::max(0.0, product * product - square * rest));
        return rest / (product + root);
    }

    /// Returns a point of the surface, or of the edges that its convex hull consists of, for two angles.
    Point3d point_at(double turn, double height) const {
        const double z = std::sin(height), r = std::cos(height);
        const Point3d way = {r * std::cos(turn), r * std::sin(turn), z};
        const auto sign = [](double number) { return number < 0 ? -1.0 : 1.0; };
        switch (kind) {
            case Nestable::sphere:
                return vector::times(way, size[0]);
            case Nestable::ellipsoid:
                return {size[0] * way[0], size[1] * way[1], size[2] * way[2]};
            case Nestable::box:
            case Nestable::box_hull:
                return {size[0] * sign(way[0]), size[1] * sign(way[1]), size[2] * sign(z)};
            case Nestable::capsule:
                return vector::plus(vector::times(way, size[0]), {0, 0, size[2] * sign(z)});
            case Nestable::cylinder:
                return {size[0] * std::cos(turn), size[0] * std::sin(turn), size[2] * sign(z)};
            case Nestable::cone:
                if (z > 0.9) return {0, 0, size[2]};
                return {size[0] * std::cos(turn), size[0] * std::sin(turn), -size[2]};
            case Nestable::octahedron:
                break;
        }
        Point3d corner = {};
        const std::size_t axis = std::fabs(z) > 0.8 ? 2 : std::fabs(way[0]) > std::fabs(way[1]) ? 0 : 1;
        corner[axis] = size[axis] * sign(way[axis]);
        return corner;
    }
};

/// Returns the largest value of a function of two angles: the best of a grid, each of the best refined.
double largest(const std::function<double(double, double)>& function) {
    struct Place {
        double value, turn, height;
    };
    constexpr int turns = 64, heights = 48;
    std::vector<Place> places;
    for (int i = 0; i < turns; ++i) {
        for (int k = 0; k <= heights; ++k) {
            const double turn = 2 * std::numbers::pi * i / turns,
                         height = std::numbers::pi * (double(k) / heights - 0.5);
            places.push_back({function(turn, height), turn, height});
        }
    }
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.value > b.value; });
    // A shape whose points depend on one angle alone has each place many times.
    const auto same = [](const Place& a, const Place& b) { return a.value == b.value; };
    places.erase(std::unique(places.begin(), places.end(), same), places.end());
    double best = 0;
    for (std::size_t i = 0; i < std::min<std::size_t>(24, places.size()); ++i) {
        Place place = places[i];
        for (double step = 0.06; step > 1e-10;) {
            const Place before = place;
            for (const auto& [turn, height] : {std::array{step, 0.0},
                                               {-step, 0.0},
                                               {0.0, step},
                                               {0.0, -step},
                                               {step, step},
                                               {step, -step},
                                               {-step, step},
                                               {-step, -step}}) {
                const Place next = {function(before.turn + turn, before.height + height), before.turn + turn,
                                    before.height + height};
                if (next.value > place.value) place = next;
            }
            if (!(place.value > before.value)) step *= 0.6;
        }
        best = std::max(best, place.value);
    }
    return best;
}

/// Two shapes of which the inner one, scaled around the outer one's origin by `border`, touches the surface from inside.
struct Nested {
    Model outer, inner;
    Pose outer_pose, inner_pose;
    double border = 0;

    /// Returns the inner shape's pose in the coordinates of the outer shape, scaled.
    Pose relative(double by) const {
        Pose pose = inner_pose;
        for (auto& row : pose.rows) row[3] *= by;
        return pose;
    }
    bool contains(double by) const {
        const ConvexSolid a = make_convex_solid(outer.shape()), b = make_convex_solid(inner.scaled(by).shape());
        const Pose in_outer = relative(by);
        Pose pose;
        for (std::size_t k = 0; k < 4; ++k) {
            const Point3d column = vector::turned(outer_pose, vector::column(in_outer, k));
            for (std::size_t i = 0; i < 3; ++i) pose.rows[i][k] = column[i] + (k == 3 ? outer_pose.rows[i][3] : 0);
        }
        return convex_contains(PosedConvex(a, outer_pose), PosedConvex(b, pose));
    }
};

Nested make_nested(Nestable outer, Nestable inner, RandomStream& random) {
    const auto lengths = [&] {
        return Point3d{random.uniform(0.2, 2), random.uniform(0.2, 2), random.uniform(0.2, 2)};
    };
    Nested nested{
        {outer, lengths()}, {inner, lengths()}, samples::random_pose(random, 1), samples::random_pose(random, 0.3)};
    const auto chance = random.below(8);
    if (chance == 0) nested.inner.size = nested.outer.size;  // nearly equal, or equal curvatures
    if (chance <= 2) nested.inner_pose = {};                 // coaxial
    if (chance == 2) nested.inner_pose.rows[2][3] = random.uniform(-0.3, 0.3);
    nested.border =
        1 / largest([&](double turn, double height) {
            return nested.outer.multiple_at(vector::posed(nested.inner_pose, nested.inner.point_at(turn, height)));
        });
    return nested;
}

class Containment : public ::testing::TestWithParam<int> {};

TEST_P(Containment, IsRightNearTheBorder) {
    const auto outer = Nestable(GetParam());
    for (int inner = 0; inner < kind_count; ++inner) {
        for (std::uint64_t i = 0; i < case_count(scaled(40, 8)); ++i) {
            const std::uint64_t seed = case_seed("containment" + std::to_string(GetParam() * kind_count + inner), i);
            RandomStream random(seed, 0);
            const Nested nested = make_nested(outer, Nestable(inner), random);
            for (const double distance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-11}) {
                SCOPED_TRACE("kind " + std::to_string(inner) + ", OCTOPAIR_TEST_SEED=" + std::to_string(seed) + ", " +
                             std::to_string(distance));
                EXPECT_FALSE(nested.contains(nested.border * (1 + distance))) << "a point sticks out";
                EXPECT_TRUE(nested.contains(nested.border * (1 - distance)));
            }
            if (HasFailure()) return;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Outer, Containment, ::testing::Range(0, kind_count));

}  // namespace
}  // namespace octopair::test
