// Tests that shapes, their boxes and the exact filters give the same results for any floating-point state of the
// caller.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>
#include <vector>

#include "octopair/filters.hpp"
#include "octopair/pipeline.hpp"
#include "samples/meshes.hpp"
#include "support/compare.hpp"
#include "support/floating_point.hpp"

namespace octopair::test {
namespace {

class PipelineFloatingPoint : public ::testing::TestWithParam<CallerState> {};

/// Input values of shapes, poses and triangles, before any computation.
struct Raw {
    std::vector<shape::Any> shapes;
    std::vector<std::uint32_t> geometry;
    std::vector<Point3d> places;
    std::vector<std::array<double, 4>> turns;
    std::vector<Triangle3d> triangles;

    Raw()
        : shapes{shape::Sphere{0.4}, shape::Cylinder{0.3, 0.7}, shape::Cone{0.3, 0.9},
                 samples::box_mesh({-0.3, -0.2, -0.4}, {0.3, 0.2, 0.4})} {
        std::mt19937_64 random(5);
        const auto unit = [&] { return double(random() >> 11) * 0x1p-53; };
        for (std::uint32_t i = 0; i < 60; ++i) {
            geometry.push_back(i % 4);
            places.push_back({2 * unit(), 2 * unit(), 2 * unit()});
            turns.push_back({unit(), unit(), unit(), unit()});
            const Point3d at = places.back();
            triangles.push_back({at, Point3d{at[0] + 0.3, at[1], at[2]}, Point3d{at[0], at[1] + 0.3, at[2] + 0.1}});
        }
    }
};

struct Found {
    std::vector<double> numbers;  ///< boxes, distances, depths and places
    std::vector<Pair> pairs;

    bool operator==(const Found&) const = default;

    void add(const Point3d& point) { numbers.insert(numbers.end(), point.begin(), point.end()); }
    void add(const Batch& batch) {
        pairs.insert(pairs.end(), batch.pairs().begin(), batch.pairs().end());
        for (const Finding& finding : batch.findings()) {
            numbers.insert(numbers.end(), {finding.distance, finding.depth});
            add(finding.nearest[0]);
            add(finding.nearest[1]);
            for (const Contact& contact : finding.contacts) add(contact.point);
        }
    }
};

Found find(const Raw& raw, const ExactOptions& exact, const Options& options) {
    Found found;
    const CollisionSink sink = [&](const Batch& batch) { found.add(batch); };
    std::vector<Geometry> geometries(raw.shapes.begin(), raw.shapes.end());
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < raw.places.size(); ++i) poses.push_back(make_pose(raw.places[i], raw.turns[i]));
    const ShapedObjects objects{geometries, raw.geometry, poses};
    check(objects);
    const std::vector<Box3d> boxes = boxes_of(objects);
    for (const Box3d& box : boxes) {
        found.numbers.insert(found.numbers.end(), box.min, box.min + 3);
        found.numbers.insert(found.numbers.end(), box.max, box.max + 3);
    }
    const auto engine = make_local_engine(2);
    Pipeline shapes(2);
    shapes.add(make_sphere_filter(objects, exact.margin));
    shapes.add(make_oriented_box_filter(objects, exact.margin));
    shapes.add(make_exact_object_filter(objects, exact));
    shapes.add(make_exact_feature_filter(objects, exact));
    shapes.run(*engine, Objects{boxes}, sink, options);
    Pipeline triangles(2);
    triangles.add(make_triangle_filter({raw.triangles}));
    triangles.run(*engine, Objects{std::span<const Box3f>(boxes_of(raw.triangles, 2))}, sink);
    return found;
}

TEST_P(PipelineFloatingPoint, ChangesNothing) {
    const Raw raw;
    const ExactOptions exact{.margin = 0.05};
    const Options options{.margin = 0.05};
    const Found expected = find(raw, exact, options);
    EXPECT_FALSE(expected.pairs.empty());
    Found found;
    call_in(GetParam(), [&] { found = find(raw, exact, options); });
    EXPECT_TRUE(same_sequence(found.pairs, expected.pairs));
    EXPECT_TRUE(same_sequence(found.numbers, expected.numbers));
}

INSTANTIATE_TEST_SUITE_P(States, PipelineFloatingPoint, ::testing::ValuesIn(caller_states()),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace octopair::test
