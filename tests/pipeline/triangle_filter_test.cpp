// Tests triangles as objects: engine and filter find the colliding pairs of triangles and report how each pair
// collides.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "boxes/outward_rounding.hpp"
#include "narrow_phase/exact/triangle_contact.hpp"
#include "narrow_phase/exact/triangle_pair.hpp"
#include "octopair/error.hpp"
#include "octopair/filters.hpp"
#include "octopair/octopair.hpp"
#include "support/compare.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

/// Triangles of several owners on a grid. Many touch, overlap and share corners.
struct Soup {
    std::vector<Triangle3d> triangles;
    std::vector<std::uint32_t> owners;

    Soup(std::uint32_t count, unsigned seed) : triangles(count), owners(count) {
        std::mt19937 random(seed);
        for (std::uint32_t i = 0; i < count; ++i) {
            Point3d middle;
            for (double& at : middle) at = double(random() % 16);
            for (Point3d& corner : triangles[i]) {
                for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] = (middle[axis] + double(random() % 4)) / 3;
            }
            owners[i] = std::uint32_t(random() % 3);
        }
    }
    TriangleSet set() const { return {triangles, owners}; }
};

struct Outcome {
    std::vector<Pair> pairs;
    std::vector<Finding> findings;
};

Outcome run(const Soup& first, const TriangleOptions& options, const Soup* second = nullptr) {
    const auto engine = make_local_engine(2);
    Pipeline pipeline(2);
    const TriangleSet second_set = second != nullptr ? second->set() : TriangleSet{};
    pipeline.add(make_triangle_filter(first.set(), options, second != nullptr ? &second_set : nullptr));
    Outcome outcome;
    const auto sink = [&](const Batch& batch) {
        outcome.pairs.insert(outcome.pairs.end(), batch.pairs().begin(), batch.pairs().end());
        outcome.findings.insert(outcome.findings.end(), batch.findings().begin(), batch.findings().end());
    };
    const auto boxes = boxes_of(first.triangles);
    Options search{.margin = options.margin};
    if (second != nullptr) {
        const auto second_boxes = boxes_of(second->triangles);
        pipeline.run(*engine, Join{{std::span(boxes)}, {std::span(second_boxes)}}, sink, search);
    } else {
        pipeline.run(*engine, {std::span(boxes)}, sink, search);
    }
    return outcome;
}

bool near(const Triangle3d& a, const Triangle3d& b, double margin) {
    return triangles_meet(a, b) || (margin > 0 && triangle_gap(a, b).distance <= margin);
}

bool share_a_corner(const Triangle3d& a, const Triangle3d& b) {
    return std::ranges::any_of(a, [&](const Point3d& corner) { return std::ranges::find(b, corner) != b.end(); });
}

TEST(TriangleFilter, FindsWhatAllPairsHold) {
    const Soup soup(700, 1);
    for (const auto adjacent :
         {AdjacentTriangles::beyond_shared, AdjacentTriangles::exclude, AdjacentTriangles::include}) {
        for (const double margin : {0.0, 0.25}) {
            std::vector<Pair> expected;
            for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
                for (std::uint32_t j = i + 1; j < soup.triangles.size(); ++j) {
                    const Triangle3d &a = soup.triangles[i], &b = soup.triangles[j];
                    const bool are_adjacent = soup.owners[i] == soup.owners[j] && share_a_corner(a, b);
                    const bool counts = !are_adjacent || adjacent == AdjacentTriangles::include ? near(a, b, margin)
                                        : adjacent == AdjacentTriangles::exclude                ? false
                                                                                 : meet_beyond_shared(a, b);
                    if (counts) expected.push_back({i, j});
                }
            }
            TriangleOptions options{.adjacent = adjacent, .margin = margin};
            const Outcome outcome = run(soup, options);
            EXPECT_TRUE(same_sequence(outcome.pairs, expected)) << int(adjacent) << " " << margin;
            EXPECT_GT(expected.size(), 300U);
            ASSERT_EQ(outcome.findings.size(), outcome.pairs.size());
        }
    }
}

TEST(TriangleFilter, JoinsHaveNoNeighbours) {
    const Soup first(300, 2), second(500, 3);
    std::vector<Pair> expected;
    for (std::uint32_t i = 0; i < first.triangles.size(); ++i) {
        for (std::uint32_t j = 0; j < second.triangles.size(); ++j) {
            if (triangles_meet(first.triangles[i], second.triangles[j])) expected.push_back({i, j});
        }
    }
    TriangleOptions options{.adjacent = AdjacentTriangles::exclude};
    EXPECT_TRUE(same_sequence(run(first, options, &second).pairs, expected));
    EXPECT_GT(expected.size(), 300U);
}

TEST(TriangleFilter, ReportsHowTheyMeetOrTheirDistance) {
    const Soup soup(700, 4);
    TriangleOptions options{.margin = 0.2, .features = true};
    const Outcome outcome = run(soup, options);
    std::array<unsigned, 6> seen = {};
    for (std::size_t k = 0; k < outcome.pairs.size(); ++k) {
        const auto [i, j] = outcome.pairs[k];
        const Triangle3d &a = soup.triangles[i], &b = soup.triangles[j];
        const Finding& finding = outcome.findings[k];
        ++seen[std::size_t(finding.collision_class)];
        if (finding.collision_class == CollisionClass::clearance) {
            EXPECT_FALSE(triangles_meet(a, b));
            EXPECT_EQ(finding.distance, triangle_gap(a, b).distance);
            EXPECT_LE(finding.distance, options.margin);
            continue;
        }
        const bool cross = triangle_contact(a, b).meeting == TriangleMeeting::crossing;
        EXPECT_EQ(finding.collision_class, cross ? CollisionClass::penetrating : CollisionClass::touching);
        ASSERT_EQ(finding.contacts.size(), 1U);
        const Contact& contact = finding.contacts[0];
        const auto& [x, y, z] = contact.normal;
        EXPECT_NEAR(std::hypot(x, y, z), 1, 1e-12);
        const Triangle3d at_contact = {contact.point, contact.point, contact.point};
        EXPECT_LT(triangle_gap(at_contact, a).distance, 1e-14);
        EXPECT_LT(triangle_gap(at_contact, b).distance, 1e-14);
    }
    for (const auto expected : {CollisionClass::clearance, CollisionClass::touching, CollisionClass::penetrating}) {
        EXPECT_GT(seen[std::size_t(expected)], 100U);
    }
}

TEST(TriangleFilter, BoxesHoldTheirTriangles) {
    constexpr double third = 1.0 / 3, huge = 1e300;
    const std::vector<Triangle3d> triangles = {{{{third, -third, 1}, {0, 0, 2}, {0, 0, huge}}}};
    const auto boxes = boxes_of(triangles);
    EXPECT_GE(double(boxes[0].max[0]), third);
    EXPECT_LT(double(std::nextafter(boxes[0].max[0], 0.0f)), third);
    EXPECT_LE(double(boxes[0].min[1]), -third);
    EXPECT_EQ(boxes[0].min[2], 1);
    EXPECT_EQ(boxes[0].max[2], std::numeric_limits<float>::max());
}

TEST(TriangleFilter, BoxesAreTheSmallestOnAnyThreads) {
    std::mt19937 random(5);
    std::vector<Triangle3d> triangles(70'001);
    for (Triangle3d& triangle : triangles) {
        for (Point3d& corner : triangle) {
            for (double& at : corner) {
                const double part = double(random()) / double(random() + 1);
                at = std::ldexp(random() % 2 == 0 ? part : -part, int(random() % 400) - 200);
                if (random() % 16 == 0) at = random() % 2 == 0 ? 0.0 : -0.0;
            }
        }
    }
    for (const unsigned threads : {1U, 2U}) {
        std::vector<Box3f> boxes(triangles.size());
        boxes_of(triangles, std::span(boxes), threads);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const auto& [a, b, c] = triangles[i];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const float low = 0.0f - rounding::finite_float_above(-std::min({a[axis], b[axis], c[axis]}));
                const float high = rounding::finite_float_above(std::max({a[axis], b[axis], c[axis]}));
                ASSERT_EQ(std::bit_cast<std::uint32_t>(boxes[i].min[axis]), std::bit_cast<std::uint32_t>(low)) << i;
                ASSERT_EQ(std::bit_cast<std::uint32_t>(boxes[i].max[axis]), std::bit_cast<std::uint32_t>(high)) << i;
            }
        }
    }
}

TEST(TriangleFilter, NamesWhatIsWrong) {
    std::vector<Triangle3d> triangles(3);
    const std::vector<std::uint32_t> owners(2);
    EXPECT_EQ(error_of(ErrorCode::bad_input,
                       [&] {
                           make_triangle_filter({triangles, owners});
                       }),
              "2 owners, but 3 triangles");
    TriangleOptions options{.margin = -1};
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { make_triangle_filter({triangles}, options); }),
              "the margin must be finite and not below 0");
    std::vector<Box3f> room(2);
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { boxes_of(triangles, std::span(room)); }),
              "boxes_of: the output has 2 boxes for 3 triangles");
    for (const double wrong : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        for (const std::size_t i : {1U, 2U}) {
            auto some = triangles;
            some[i][1][2] = wrong;
            const auto message = "triangle " + std::to_string(i) + " has a corner that is not finite";
            EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { boxes_of(some); }), message);
            EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { make_triangle_filter({some}); }), message);
        }
    }
    auto second = triangles;
    second[1][0][0] = std::nan("");
    const TriangleSet wrong_second{second};
    expect_place([&] { (void)make_triangle_filter({second}); }, 1, 0);
    expect_place([&] { (void)make_triangle_filter({triangles}, {}, &wrong_second); }, 1, 1);
    triangles[2][1][0] = std::nan("");
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { boxes_of(triangles); }),
              "triangle 2 has a corner that is not finite");
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { make_triangle_filter({triangles}); }),
              "triangle 2 has a corner that is not finite");
}

}  // namespace
}  // namespace octopair::test
