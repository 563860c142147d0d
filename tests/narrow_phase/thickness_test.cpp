// Tests the thickness of overlaps: of parts that fit snugly and of parts that collide, by construction; and of random overlaps against a
// dense search for the largest ball, which shares no code with the library.
#include <gtest/gtest.h>

#include <stop_token>
#include <string>
#include <vector>

#include "narrow_phase/object_pair.hpp"
#include "narrow_phase/solid_samples.hpp"
#include "samples/meshes.hpp"
#include "samples/random.hpp"

namespace octopair::test {
namespace {

constexpr double tolerance = 1;

Finding judged(const shape::Mesh& a, const shape::Mesh& b, const Pose& pose) {
    const Geometry first(a), second(b);
    EXPECT_TRUE(first.closed() && second.closed());
    const PosedObject posed_a{detail::prepared(first), pose}, posed_b{detail::prepared(second), pose};
    Finding finding;
    if (!judge_objects(posed_a, posed_b, 0, finding)) return finding;
    const std::stop_token stop;
    find_contacts(posed_a, posed_b, {.max_contacts = 0, .stop = stop, .tolerance = tolerance}, finding);
    return finding;
}

struct Case {
    std::string name;
    shape::Mesh a, b;
};

/// Checks a case as given, turned and far from the origin, and with a and b exchanged.
void expect_class(const Case& at, CollisionClass wanted) {
    SCOPED_TRACE(at.name);
    samples::RandomStream random(1, 0);
    Pose turned = samples::random_pose(random, 100), far = samples::random_pose(random, 1000);
    far.rows[0][3] += 1e5;
    for (const Pose& pose : {Pose{}, turned, far}) {
        for (const bool swapped : {false, true}) {
            const Finding finding = swapped ? judged(at.b, at.a, pose) : judged(at.a, at.b, pose);
            EXPECT_EQ(finding.collision_class, wanted)
                << at.name << "thickness " << finding.thickness << " kind " << int(finding.thickness_kind) << " depth "
                << finding.depth << " to " << finding.depth_at_most;
            if (wanted == CollisionClass::touching) {
                EXPECT_EQ(finding.thickness_kind, ThicknessKind::at_most);
                EXPECT_LE(finding.thickness, tolerance * (1 + 1e-9));
            }
        }
    }
}

Case bolt(double overlap) {
    const unsigned corners = 24;
    return {"bolt", ring(regular_outline(corners, 40), regular_outline(corners, 10 - overlap), 0, 30),
            revolved({{0, 34}, {14, 34}, {14, 30 - overlap / 2}, {10, 30 - overlap / 2}, {10, -10}, {0, -10}}, corners,
                     false)};
}

Case dowel(double overlap) {
    const unsigned corners = 32;
    return {"dowel in a blind hole",
            revolved({{0, 5}, {10 - overlap, 5}, {10 - overlap, 30}, {40, 30}, {40, 0}, {0, 0}}, corners, false),
            prism(regular_outline(corners, 10), 5 - overlap, 60)};
}

Case window(double overlap) {
    const Outline wall = rectangle(3000, 1500), hole = rectangle(1000 - overlap, 600 - overlap);
    return {"window", ring(wall, hole, 0, 300), ring(rectangle(1000, 600), rectangle(920, 520), 100, 180)};
}

Case spline(double overlap) {
    const Outline gear = gear_outline(12, 20, 25);
    return {"spline", prism(gear, -5, 35), ring(regular_outline(48, 40), scaled(gear, 1 - overlap / 25), 0, 30)};
}

Case gears(double overlap) {
    std::vector<double> xs, lower, upper;
    for (int i = 0; i <= 40; ++i) {
        xs.push_back(3 * i);
        const double height = i % 4 < 2 ? 0 : 6;
        lower.push_back(height + overlap);
        upper.push_back(height);
    }
    shape::Mesh mate = comb(xs, upper, 16, 20);
    // The comb hangs down from z = 16 to the teeth: its triangles face inward.
    return {"racks", comb(xs, lower, -10, 20), moved(turned_inside_out(mate), {})};
}

Case threads(double overlap) {
    std::vector<Point2d> screw = {{0, 42}}, nut = {{25, 30}, {25, 0}};
    for (int i = 20; i >= -1; --i) screw.push_back({i % 2 == 0 ? 8.0 : 10.0, 2.0 * i});
    screw.push_back({0, -2});
    for (int i = 0; i <= 15; ++i) nut.push_back({(i % 2 == 0 ? 8.0 : 10.0) - overlap, 2.0 * i});
    return {"threads", revolved(screw, 24, false), revolved(nut, 24, true)};
}

Case cavity(double overlap) {
    return {"ball in a cavity",
            joined(samples::sphere_mesh(20, 3), turned_inside_out(samples::sphere_mesh(10 - overlap, 3))),
            samples::sphere_mesh(10, 3)};
}

Case spikes(double overlap) {
    shape::Mesh ball = samples::sphere_mesh(10, 3);
    for (std::size_t i = 0; i < ball.vertices.size(); i += 2) {
        for (double& at : ball.vertices[i]) at *= 1.05;
    }
    return {"ball with spikes in a cavity",
            joined(samples::sphere_mesh(20, 3), turned_inside_out(samples::sphere_mesh(10.5 - overlap, 3))), ball};
}

const std::vector<Case (*)(double)> fits = {bolt, dowel, window, spline, gears, threads, cavity, spikes};

TEST(Thickness, SnugFitsTouch) {
    for (const double overlap : {0.0, 1e-6, 0.1, 0.3}) {
        for (const auto make : fits) expect_class(make(overlap), CollisionClass::touching);
    }
}

TEST(Thickness, OverlapsOfTwiceTheTolerancePenetrate) {
    for (const auto make : fits) expect_class(make(2 * tolerance), CollisionClass::penetrating);
}

/// What goes through a plate thinner than the tolerance penetrates.
TEST(Thickness, RodsThroughPlatesPenetrate) {
    for (const double thickness : {0.05, 0.3, 0.9, 1.0, 1.1, 2.0, 5.0}) {
        for (const double radius : {0.1, 0.4, 0.6, 3.0}) {
            expect_class(
                {"rod of " + std::to_string(radius) + " through " + std::to_string(thickness),
                 samples::box_mesh({-20, -20, 0}, {20, 20, thickness}), prism(regular_outline(16, radius), -10, 15)},
                CollisionClass::penetrating);
        }
    }
}

/// The thickness of the plate where the rod goes through it counts, not that of the whole object.
TEST(Thickness, RodsThroughTheWebOfABeamPenetrate) {
    const shape::Mesh web = samples::box_mesh({-0.25, 0, 0}, {0.25, 200, 40}),
                      flange = samples::box_mesh({-20, 0, 39}, {20, 200, 44});
    const shape::Mesh rod = samples::box_mesh({-30, 90, 10}, {30, 100, 20});
    expect_class({"web and flange", joined(web, flange), rod}, CollisionClass::penetrating);
}

TEST(Thickness, WallsThatRunIntoEachOther) {
    const shape::Mesh wall = samples::box_mesh({0, 0, 0}, {1000, 200, 3000});
    expect_class({"by 10", wall, samples::box_mesh({990, 0, 0}, {2000, 200, 3000})}, CollisionClass::penetrating);
    expect_class({"by 0.5", wall, samples::box_mesh({999.5, 0, 0}, {2000, 200, 3000})}, CollisionClass::touching);
}

}  // namespace
}  // namespace octopair::test
