// Tests the thickness of overlaps: of parts that fit snugly and of parts that collide, by construction; and of random overlaps against a
// dense search for the largest ball, which shares no code with the library.
#include <gtest/gtest.h>

#include <stop_token>
#include <string>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/largest_ball.hpp"
#include "narrow_phase/object_pair.hpp"
#include "narrow_phase/solid_samples.hpp"
#include "narrow_phase/thickness/polygon.hpp"
#include "samples/meshes.hpp"
#include "samples/random.hpp"
#include "support/cases.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr double tolerance = 1;

Finding judged(const shape::Any& a, const shape::Any& b, const Pose& pose, double most = tolerance) {
    const Geometry first(a), second(b);
    EXPECT_TRUE(first.closed() && second.closed());
    const PosedObject posed_a{detail::prepared(first), pose}, posed_b{detail::prepared(second), pose};
    Finding finding;
    if (!judge_objects(posed_a, posed_b, 0, finding)) return finding;
    const std::stop_token stop;
    find_contacts(posed_a, posed_b, {.max_contacts = 0, .stop = stop, .tolerance = most}, finding);
    return finding;
}

shape::Mesh posed(shape::Mesh mesh, const Pose& pose) {
    for (Point3d& vertex : mesh.vertices) vertex = vector::posed(pose, vertex);
    return mesh;
}

struct Overlap {
    std::string name;
    shape::Mesh a, b;
};

/// Checks a case as given, turned and far from the origin, and with a and b exchanged.
void expect_class(const Overlap& at, CollisionClass wanted) {
    SCOPED_TRACE(at.name);
    samples::RandomStream random(1, 0);
    Pose turned = samples::random_pose(random, 100), far = samples::random_pose(random, 1000);
    far.rows[0][3] += 1e5;
    const Pose mirrored{{{{-1, 0, 0, 3}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
    const std::vector<Pose> poses = sanitized ? std::vector{turned} : std::vector{Pose{}, turned, far, mirrored};
    for (const Pose& pose : poses) {
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

Overlap bolt(double overlap) {
    const unsigned corners = 24;
    return {"bolt", ring(regular_outline(corners, 40), regular_outline(corners, 10 - overlap), 0, 30),
            revolved({{0, 34}, {14, 34}, {14, 30 - overlap / 2}, {10, 30 - overlap / 2}, {10, -10}, {0, -10}}, corners,
                     false)};
}

Overlap dowel(double overlap) {
    const unsigned corners = 32;
    return {"dowel in a blind hole",
            revolved({{0, 5}, {10 - overlap, 5}, {10 - overlap, 30}, {40, 30}, {40, 0}, {0, 0}}, corners, false),
            prism(regular_outline(corners, 10), 5 - overlap, 60)};
}

Overlap window(double overlap) {
    const Outline wall = rectangle(3000, 1500), hole = rectangle(1000 - overlap, 600 - overlap);
    return {"window", ring(wall, hole, 0, 300), ring(rectangle(1000, 600), rectangle(920, 520), 100, 180)};
}

Overlap spline(double overlap) {
    const Outline gear = gear_outline(12, 20, 25);
    return {"spline", prism(gear, -5, 35), ring(regular_outline(48, 40), scaled(gear, 1 - overlap / 25), 0, 30)};
}

Overlap gears(double overlap) {
    std::vector<double> xs, lower, upper;
    for (int i = 0; i <= 40; ++i) {
        xs.push_back(3 * i);
        const double height = i % 4 < 2 ? 0 : 6;
        lower.push_back(height + overlap);
        upper.push_back(height);
    }
    shape::Mesh mate = comb(xs, upper, 16, 20);
    // The comb hangs down from z = 16 to the teeth: its triangles face inward.
    return {"racks", comb(xs, lower, -10, 20), moved(turned_inside_out(mate), {0, 4, 0})};
}

Overlap threads(double overlap) {
    std::vector<Point2d> screw = {{0, 42}}, nut = {{25, 30}, {25, 0}};
    for (int i = 20; i >= -1; --i) screw.push_back({i % 2 == 0 ? 8.0 : 10.0, 2.0 * i});
    screw.push_back({0, -2});
    for (int i = 0; i <= 15; ++i) nut.push_back({(i % 2 == 0 ? 8.0 : 10.0) - overlap, 2.0 * i});
    return {"threads", revolved(screw, 24, false), revolved(nut, 24, true)};
}

Overlap cavity(double overlap) {
    return {"ball in a cavity",
            joined(samples::sphere_mesh(20, 3), turned_inside_out(samples::sphere_mesh(10 - overlap, 3))),
            samples::sphere_mesh(10, 3)};
}

Overlap spikes(double overlap) {
    shape::Mesh ball = samples::sphere_mesh(10, 3);
    for (std::size_t i = 0; i < ball.vertices.size(); i += 2) {
        for (double& at : ball.vertices[i]) at *= 1.05;
    }
    return {"ball with spikes in a cavity",
            joined(samples::sphere_mesh(20, 3), turned_inside_out(samples::sphere_mesh(10.5 - overlap, 3))), ball};
}

/// A bolt with few sides that sticks out of a plate on both sides.
template <unsigned corners>
Overlap pin(double overlap) {
    return {"pin", ring(regular_outline(corners, 40), regular_outline(corners, 10 - overlap), 0, 3),
            prism(regular_outline(corners, 10), -10, 15)};
}

/// A block between two wedges, whose acute edges lie on it.
Overlap clamp(double overlap) {
    const shape::Mesh below = prism({{0, 0}, {0, -50}, {50, -50}, {100, 0}}, 0, 300),
                      above = prism({{0, 40}, {100, 40}, {50, 90}, {0, 90}}, 0, 300);
    return {"block between acute edges", joined(below, above),
            prism({{-30, -overlap}, {200, -overlap}, {200, 40 + overlap}, {-30, 40 + overlap}}, 100, 200)};
}

const std::vector<Overlap (*)(double)> fits = {bolt,   dowel,  window, spline,  gears, cavity,
                                               spikes, pin<4>, pin<6>, pin<24>, clamp};

TEST(Thickness, SnugFitsTouch) {
    for (const double overlap : {0.0, 1e-4, 0.45}) {
        for (const auto make : fits) expect_class(make(overlap), CollisionClass::touching);
    }
}

/// Threads take thousands of boxes, so there is one pose for each overlap.
TEST(Thickness, ThreadsTouch) {
    expect_class(threads(0), CollisionClass::touching);
    for (const double overlap : {1e-4, 0.3}) {
        if (sanitized && overlap > 0.1) continue;
        const Overlap at = threads(overlap);
        const Finding finding = judged(at.a, at.b, {});
        EXPECT_EQ(finding.collision_class, CollisionClass::touching) << overlap << ": " << finding.thickness;
    }
}

/// At the ends of threads, where three faces meet, larger overlaps stay undecided. They never count as thick.
TEST(Thickness, ThreadsAreNeverThick) {
    const Overlap at = threads(0.8);
    EXPECT_NE(judged(at.a, at.b, {}).thickness_kind, ThicknessKind::at_least);
}

TEST(Thickness, OverlapsOfTwiceTheTolerancePenetrate) {
    for (const auto make : fits) expect_class(make(2 * tolerance), CollisionClass::penetrating);
    expect_class(threads(2 * tolerance), CollisionClass::penetrating);
}

/// What goes through a plate thinner than the tolerance penetrates.
TEST(Thickness, RodsThroughPlatesPenetrate) {
    for (const double thickness : {0.05, 0.9, 5.0}) {
        for (const double radius : {0.1, 0.6, 3.0}) {
            expect_class(
                {"rod of " + std::to_string(radius) + " through " + std::to_string(thickness),
                 samples::box_mesh({-20, -20, 0}, {20, 20, thickness}), prism(regular_outline(16, radius), -10, 15)},
                CollisionClass::penetrating);
        }
    }
}

/// The thickness of the plate where the rod goes through it counts, not that of the whole object.
/// Rods whose faces are not exactly opposite, tapered plates, meshes that are inside out, and rods through thick blocks.
TEST(Thickness, WhatGoesThroughPenetratesInAnyForm) {
    const shape::Mesh thin = samples::box_mesh({-20, -20, 0}, {20, 20, 0.5}),
                      block = samples::box_mesh({-20, -20, -20}, {20, 20, 20});
    for (const unsigned corners : {3U, 7U, 25U}) {
        for (const double radius : {0.4}) {
            const shape::Mesh rod = prism(regular_outline(corners, radius), -30, 30);
            const std::string name = std::to_string(corners) + " corners, radius " + std::to_string(radius);
            expect_class({name + ", thin", thin, rod}, CollisionClass::penetrating);
            expect_class({name + ", thin, inside out", turned_inside_out(thin), rod}, CollisionClass::penetrating);
            expect_class({name + ", block", block, turned_inside_out(rod)}, CollisionClass::penetrating);
        }
    }
    for (const double slope : {0.002, 0.14}) {
        const shape::Mesh wedge = comb({-20, 20}, {0.5, 0.5 + 40 * slope}, 0, 40);
        for (const unsigned corners : {7U, 16U}) {
            for (const double radius : {0.8}) {
                const shape::Mesh rod = moved(prism(regular_outline(corners, radius), -30, 30), {-19 + radius, 20, 0});
                expect_class({"slope " + std::to_string(slope), wedge, rod}, CollisionClass::penetrating);
            }
        }
    }
}

/// Lines from edge to edge leave through both solids there, also through the middle of the overlap.
TEST(Thickness, SquareRodsThroughSheetsOfTheirThicknessPenetrate) {
    const auto block = [](double x, double y, double z) {
        return samples::box_mesh({-x / 2, -y / 2, -z / 2}, {x / 2, y / 2, z / 2});
    };
    for (const double width : {0.3, 0.5, 0.7}) {
        const shape::Mesh sheet = block(20, 20, width);
        const CollisionClass wanted = CollisionClass::penetrating;
        expect_class({"rod", sheet, block(width, width, 20)}, wanted);
        expect_class({"wider rod", sheet, block(1.02 * width, width, 20)}, wanted);
        expect_class({"blade", sheet, block(width, 10, 20)}, wanted);
        expect_class({"octagonal rod", sheet, prism(regular_outline(8, width / 2), -10, 10)}, wanted);
        expect_class({"turned rod", sheet, prism(regular_outline(4, width / 2), -10, 10)}, wanted);
    }
}

/// Points on a few lines, most of them several times but for the last bits: as the corners of a polyhedron that planes cut.
TEST(Thickness, PrismsHaveAllTheirPoints) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
        samples::RandomStream random(59, i);
        const auto direction = direction_of({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
        const Point3d u = vector::some_normal(*direction), v = vector::cross(*direction, u);
        std::vector<Point3d> points;
        for (std::uint64_t line = 0; line < 4; ++line) {
            const Point3d from = {random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)},
                          way = line % 2 == 0 ? u : vector::plus(u, v);
            for (std::uint64_t k = 0; k < 3; ++k) {
                const Point3d at = vector::plus(from, vector::times(way, random.uniform(-5, 5)));
                for (std::uint64_t copy = 0; copy < 3; ++copy) {
                    Point3d& point = points.emplace_back(at);
                    for (double& coordinate : point) coordinate += random.uniform(-2e-15, 2e-15);
                }
            }
        }
        for (const CutPlane& plane : prism_over(points, *direction)) {
            for (const Point3d& point : points) ASSERT_LE(plane.height(point), 1e-12) << i;
        }
    }
}

TEST(Thickness, BeyondTheRangeOfFloat32NothingIsProven) {
    const shape::Mesh cube = samples::box_mesh({0, 0, 0}, {1e39, 1e39, 1e39});
    EXPECT_EQ(judged(cube, moved(cube, {5e38, 5e38, 5e38}), {}, 1e38).collision_class, CollisionClass::penetrating);
}

TEST(Thickness, RodsThroughTheWebOfABeamPenetrate) {
    const shape::Mesh web = samples::box_mesh({-0.25, 0, 0}, {0.25, 200, 40}),
                      flange = samples::box_mesh({-20, 0, 39}, {20, 200, 44});
    const shape::Mesh rod = samples::box_mesh({-30, 90, 10}, {30, 100, 20});
    expect_class({"web and flange", joined(web, flange), rod}, CollisionClass::penetrating);
}

/// Solids that are not meshes, in meshes that hold them on all sides.
TEST(Thickness, CurvedSolidsFitSnugly) {
    const auto plate = [](double radius) {
        return ring(regular_outline(48, 40), regular_outline(48, radius), -15, 15);
    };
    const auto shell = [](double radius) {
        return joined(samples::sphere_mesh(40, 3), turned_inside_out(samples::sphere_mesh(radius, 3)));
    };
    const shape::Mesh wall = ring(rectangle(60, 60), rectangle(9.7, 19.7), -15, 15),
                      loose = ring(rectangle(60, 60), rectangle(8, 18), -15, 15);
    struct Pairing {
        shape::Any solid, snug, tight;
    };
    const std::vector<Pairing> pairings = {
        {shape::Cylinder{10, 60}, plate(9.8), plate(8)},
        {shape::Capsule{10, 60}, plate(9.8), plate(8)},
        {shape::Sphere{20}, shell(19.9), shell(17)},
        {shape::Ellipsoid{{20, 20, 20}}, shell(19.9), shell(17)},
        {shape::Cone{20, 60}, ring(regular_outline(48, 40), regular_outline(48, 14.8), -15, -14.7), plate(8)},
        {shape::Box{{10, 20, 30}}, wall, loose},
    };
    for (std::size_t i = 0; i < pairings.size(); ++i) {
        SCOPED_TRACE(i);
        const auto& [solid, snug, tight] = pairings[i];
        for (const bool swapped : {false, true}) {
            const Finding snugly = swapped ? judged(solid, snug, {}) : judged(snug, solid, {});
            EXPECT_EQ(snugly.collision_class, CollisionClass::touching) << snugly.thickness;
            const Finding collides = swapped ? judged(solid, tight, {}) : judged(tight, solid, {});
            EXPECT_EQ(collides.collision_class, CollisionClass::penetrating);
            EXPECT_EQ(collides.thickness_kind, ThicknessKind::at_least);
            EXPECT_GT(collides.thickness, tolerance);
        }
    }
}

TEST(Thickness, WallsThatRunIntoEachOther) {
    const shape::Mesh wall = samples::box_mesh({0, 0, 0}, {1000, 200, 3000});
    expect_class({"by 10", wall, samples::box_mesh({990, 0, 0}, {2000, 200, 3000})}, CollisionClass::penetrating);
    expect_class({"by 0.5", wall, samples::box_mesh({999.5, 0, 0}, {2000, 200, 3000})}, CollisionClass::touching);
}

/// Returns two solids that overlap, most of them by little.
Overlap random_overlap(samples::RandomStream& random) {
    const double overlap = random.uniform(0, 2.5);
    const Point3d offset = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const auto corners = unsigned(3 + random.below(8));
    switch (random.below(8)) {
        case 0: {
            const shape::Mesh box = samples::box_mesh({0, 0, 0}, {20, 15, 10});
            return {"boxes", box, posed(moved(box, {20 - overlap, 0, 0}), samples::random_pose(random, 0.5))};
        }
        case 1: {
            const Pose near = samples::random_pose(random, 3);
            return {"tori", samples::torus_mesh({8, 6, 0.3, random.next()}),
                    posed(samples::torus_mesh({7, 5, 0.2, random.next()}), near)};
        }
        case 2:
            return {"peg", ring(regular_outline(corners, 40), regular_outline(corners, 10 - overlap), 0, 9),
                    moved(prism(regular_outline(corners, 10), -4, 12), offset)};
        case 3: {
            const Outline gear = gear_outline(corners, 12, 15);
            return {"spline", ring(regular_outline(4 * corners, 25), scaled(gear, 1 - overlap / 15), 0, 9),
                    moved(prism(gear, -3, 12), offset)};
        }
        case 4:
            return {"rod", samples::box_mesh({-10, -10, 0}, {10, 10, overlap + 0.1}),
                    posed(prism(regular_outline(corners, random.uniform(0.1, 3)), -20, 20),
                          samples::random_pose(random, 4))};
        case 5:
            return {"ball",
                    joined(samples::sphere_mesh(20, 1), turned_inside_out(samples::sphere_mesh(10 - overlap, 1))),
                    moved(samples::sphere_mesh(10, 1), offset)};
        case 6: {
            std::vector<double> xs, heights;
            for (int i = 0; i < 12; ++i)
                xs.push_back(2 * i + random.uniform(0, 1.5)), heights.push_back(random.uniform(3, 6));
            std::vector<double> upper = heights;
            for (double& height : upper) height -= overlap * random.uniform(0, 1);
            return {"combs", comb(xs, heights, -5, 8),
                    moved(turned_inside_out(comb(xs, upper, 16, 8)), {0, offset[0], 0})};
        }
        default:
            return {"window", ring(rectangle(30, 20), rectangle(10 - overlap, 8 - overlap), 0, 5),
                    moved(ring(rectangle(10, 8), rectangle(7, 5), -1, 3), offset)};
    }
}

/// No overlap that a dense search finds to be thicker than the tolerance is touching. Tolerances are near the found thickness.
TEST(Thickness, NoThickOverlapTouches) {
    const std::uint64_t count = case_count(scaled(60, 10));
    std::uint64_t touching = 0, thin = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        samples::RandomStream random(58, i);
        const Overlap at = random_overlap(random);
        const double ball = largest_ball(at.a, at.b, 7);
        if (!(ball > 0)) continue;
        const double most = ball * random.uniform(0.5, 4);
        const Finding finding = judged(at.a, at.b, {}, most);
        const bool touches = finding.collision_class == CollisionClass::touching;
        touching += touches;
        thin += 2 * ball < most && at.name != "rod";
        EXPECT_FALSE(touches && ball > most * (1 + 1e-9)) << at.name << " " << i << ": " << ball << " at " << most;
        if (finding.thickness_kind != ThicknessKind::at_most) continue;
        EXPECT_LE(ball, finding.thickness * (1 + 1e-9) + 1e-9) << at.name << " " << i;
    }
    // Most overlaps of half the tolerance are proven, unless they go through a solid.
    EXPECT_GE(touching * 2, thin) << touching << " of " << thin;
}

}  // namespace
}  // namespace octopair::test
