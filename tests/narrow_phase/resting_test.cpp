// Tests small shapes that rest exactly on a face of a larger shape: they touch, and penetrate as soon as they sink in.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "narrow_phase/object_pair.hpp"
#include "samples/meshes.hpp"
#include "samples/random.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using samples::RandomStream;

/// Returns the pose that applies `first`, then `second`.
Pose joined(const Pose& second, const Pose& first) {
    Pose both;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            both.rows[i][k] = k == 3 ? second.rows[i][3] : 0;
            for (std::size_t j = 0; j < 3; ++j) both.rows[i][k] += second.rows[i][j] * first.rows[j][k];
        }
    }
    return both;
}

Pose at(double x, double y, double z) { return make_pose({x, y, z}); }
/// Rotations by a quarter and by a half turn about x. They are exact.
const Pose quarter_turn = {{{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}}};
const Pose half_turn = {{{{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}}}};

struct Placed {
    std::string name;
    Geometry geometry;
    Pose pose;
    double size = 1;  // radius of the sphere around the shape, about
};

/// Returns shapes with a face in the plane z = 0 that contains the square from -half / 2 to half / 2. The shapes are below it.
std::vector<Placed> floors(double half) {
    const shape::ConvexHull hull{{{-half, -half, 0},
                                  {half, -half, 0},
                                  {half, half, 0},
                                  {0, 1.25 * half, 0},
                                  {-half, half, 0},
                                  {-half / 4, half / 8, -half / 2},
                                  {half / 2, -half / 4, -half / 4}}};
    const shape::ConvexHull wedge{
        {{-2 * half, -2 * half, 0}, {2 * half, -2 * half, 0}, {0, 4 * half, 0}, {0, 0, -half}}};
    const shape::Mesh ground{{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}},
                             {{0, 1, 2}, {0, 2, 3}}};
    return {{"box", Geometry(shape::Box{{half, half, 4}}), at(0, 0, -4)},
            {"cylinder", Geometry(shape::Cylinder{half, 8}), at(0, 0, -4)},
            {"cone", Geometry(shape::Cone{half, 8}), joined(at(0, 0, -4), half_turn)},
            {"hull", Geometry(hull), at(0, 0, 0)},
            {"wedge", Geometry(wedge), at(0, 0, 0)},
            {"closed mesh", Geometry(samples::box_mesh({-half, -half, -8}, {half, half, 0})), at(0, 0, 0)},
            {"open mesh", Geometry(ground), at(0, 0, 0)},
            {"plane", Geometry(shape::Plane{{0, 0, 1}, 0}), at(0, 0, 0)}};
}

/// Returns shapes of about the size 0.25 whose lowest points have z = 0, near the z axis.
std::vector<Placed> things() {
    const shape::ConvexHull tip{{{0, 0, 0}, {0.25, 0, 0.25}, {-0.125, 0.25, 0.25}, {-0.125, -0.25, 0.375}}};
    const shape::ConvexHull block{{{0, 0, 0}, {0.25, 0, 0}, {0.125, 0.25, 0}, {0, 0.125, 0.25}, {0.125, 0, 0.375}}};
    return {{"sphere", Geometry(shape::Sphere{0.25}), at(0, 0, 0.25)},
            {"standing capsule", Geometry(shape::Capsule{0.25, 0.5}), at(0, 0, 0.5)},
            {"lying capsule", Geometry(shape::Capsule{0.25, 0.5}), joined(at(0, 0, 0.25), quarter_turn)},
            {"box", Geometry(shape::Box{{0.25, 0.125, 0.25}}), at(0, 0, 0.25)},
            {"standing cylinder", Geometry(shape::Cylinder{0.25, 0.5}), at(0, 0, 0.25)},
            {"lying cylinder", Geometry(shape::Cylinder{0.25, 0.5}), joined(at(0, 0, 0.25), quarter_turn)},
            {"standing cone", Geometry(shape::Cone{0.25, 0.5}), at(0, 0, 0.25)},
            {"cone on its tip", Geometry(shape::Cone{0.25, 0.5}), joined(at(0, 0, 0.25), half_turn)},
            {"ellipsoid", Geometry(shape::Ellipsoid{{0.25, 0.125, 0.25}}), at(0, 0, 0.25)},
            {"hull on its tip", Geometry(tip), at(0, 0, 0)},
            {"hull on its face", Geometry(block), at(0, 0, 0)},
            {"mesh", Geometry(samples::box_mesh({0, 0, 0}, {0.25, 0.125, 0.25})), at(0, 0, 0)}};
}

Finding finding_of(const Placed& a, const Placed& b) {
    Finding finding;
    const PosedObject first{detail::prepared(a.geometry), a.pose}, second{detail::prepared(b.geometry), b.pose};
    EXPECT_TRUE(judge_objects(first, second, 0, finding));
    find_contacts(first, second, {4, {}}, finding);
    return finding;
}

/// Returns a turn about z. It changes no z coordinate.
Pose turn_about_z(RandomStream& random) {
    const double angle = random.uniform(0, 7), c = std::cos(angle), s = std::sin(angle);
    return {{{{c, -s, 0, 0}, {s, c, 0, 0}, {0, 0, 1, 0}}}};
}

/// Returns a rotation by quarter turns about all axes, and a translation to a place of few digits.
Pose exact_pose(RandomStream& random) {
    Pose pose;
    for (auto turns = random.below(4); turns > 0; --turns) pose = joined(quarter_turn, pose);
    if (random.below(2) == 1) std::rotate(pose.rows.begin(), pose.rows.begin() + 1, pose.rows.end());
    for (auto& row : pose.rows) row[3] = double(random.below(1 << 12));
    return pose;
}

/// Where a thing rests, in which direction down is, and how large the floor is.
struct Arrangement {
    double half;
    Pose whole, turn, place;
};

void expect_rests(const Arrangement& here, Placed floor, const Placed& thing) {
    SCOPED_TRACE(thing.name + " on " + floor.name + ", half side " + std::to_string(here.half));
    floor.pose = joined(here.whole, floor.pose);
    const auto sunk = [&](double by) {
        const Pose local = joined(here.place, joined(here.turn, thing.pose));
        return Placed{thing.name, thing.geometry, joined(here.whole, joined(at(0, 0, -by), local))};
    };
    const Finding resting = finding_of(floor, sunk(0));
    EXPECT_EQ(resting.collision_class, CollisionClass::touching) << resting.depth;
    EXPECT_EQ(resting.depth, 0);
    const double depth = 0x1p-32;  // 1e-9 of the thing's radius
    const Finding lower = finding_of(floor, sunk(depth));
    EXPECT_EQ(lower.collision_class, CollisionClass::penetrating) << lower.depth;
    EXPECT_LE(lower.depth, 2 * depth);
}

bool is_mesh(const Placed& placed) { return std::holds_alternative<shape::Mesh>(placed.geometry.shape()); }

/// Tests all things on all floors whose half side is `ratio` quarters.
void expect_all_rest(double ratio, const Pose& whole, bool turned, RandomStream& random) {
    const double half = std::max(0.5, std::floor(ratio)) / 4;
    const auto anywhere = [&] { return half < 1 ? 0 : std::floor(random.uniform(-half / 2, half / 2) * 64) / 64; };
    for (const Placed& floor : floors(half)) {
        for (const Placed& thing : things()) {
            // Signs of integers decide about two meshes, so any rounding of a turned mesh decides.
            if (turned && is_mesh(floor) && is_mesh(thing)) continue;
            const double x = anywhere(), y = anywhere();
            expect_rests({half, whole, turn_about_z(random), at(x, y, 0)}, floor, thing);
        }
    }
}

TEST(Resting, SmallShapesTouchLargeFacesExactly) {
    RandomStream random(31, 0);
    for (std::uint64_t i = 0; i < scaled(40, 8); ++i) {
        expect_all_rest(std::pow(10, random.uniform(0.3, 6)), exact_pose(random), false, random);
    }
}

TEST(Resting, TurnedArrangementsTouchWhileRoundingIsSmall) {
    RandomStream random(32, 0);
    for (std::uint64_t i = 0; i < scaled(40, 8); ++i) {
        expect_all_rest(std::pow(10, random.uniform(0.3, 1.8)), samples::random_pose(random, 1), true, random);
    }
}

}  // namespace
}  // namespace octopair::test
