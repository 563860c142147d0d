// Tests queries on large scenes, many queries at the same time, any number of threads, and invalid queries.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "base/tuning.hpp"
#include "octopair/octopair.hpp"
#include "scene/query_model.hpp"
#include "support/calls.hpp"
#include "support/errors.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class SceneQueriesTest : public ::testing::TestWithParam<std::string> {};

/// A scene of one kind and its model.
struct Pool {
    Pool(const std::string& kind, std::uint64_t objects, unsigned threads) : scene({threads}) {
        const std::vector<Box3f> boxes = make_boxes(kind, objects, 21);
        std::vector<ObjectId> ids(boxes.size());
        scene.add(Objects{boxes}, ids);
        scene.step();
        const std::vector<Box3d> wide = widened(boxes);
        for (std::size_t i = 0; i < ids.size(); ++i) model.objects[ids[i].index] = {ids[i], wide[i], 0, {}};
    }

    Scene scene;
    Model model;
};

TEST_P(SceneQueriesTest, OfALargeSceneAreWhatBruteForceFinds) {
    Pool pool(GetParam(), scaled(3000, 1000), 1);
    for (std::uint64_t seed = 0; seed < scaled(10, 3); ++seed) {
        QueryModel(pool.model, pool.scene, seed).check();
        if (HasFatalFailure()) return;
    }
}

TEST_P(SceneQueriesTest, ManyAtOnceAreAnsweredLikeOneByOne) {
    constexpr std::size_t queries = 300;
    ASSERT_GT(queries, tuning().scene.min_sorted_queries);  // many queries are answered in another order
    Pool one(GetParam(), 800, 1), three(GetParam(), 800, 3);
    const std::vector<Box3d> boxes = widened(make_boxes(GetParam(), queries, 22));
    std::vector<Ray> rays;
    std::vector<Sphere> spheres;
    for (const Box3d& box : boxes) {
        spheres.push_back({{box.min[0], box.min[1], box.min[2]}, 0.25});
        rays.push_back({{box.min[0], box.min[1], box.min[2]}, {1, rays.size() % 2 == 0 ? 0.0 : -0.5, 0.25}});
    }
    const auto compare = [&](auto ask, auto answers, auto ask_one) {
        auto again = answers;
        ask(one.scene, answers);
        ask(three.scene, again);
        ASSERT_EQ(answers.all, again.all);
        ASSERT_EQ(answers.ends, again.ends);
        for (std::size_t i = 0; i < answers.size(); ++i) {
            const auto answer = answers[i];
            ASSERT_EQ(std::vector(answer.begin(), answer.end()), ask_one(i));
        }
    };
    compare([&](Scene& scene, auto& out) { scene.overlaps(boxes, out); }, Answers<std::uint32_t>(),
            [&](std::size_t i) { return one.scene.overlaps(boxes[i]); });
    compare([&](Scene& scene, auto& out) { scene.overlaps(spheres, out); }, Answers<std::uint32_t>(),
            [&](std::size_t i) { return one.scene.overlaps(spheres[i]); });
    compare([&](Scene& scene, auto& out) { scene.all_hits(rays, out); }, Answers<RayHit>(),
            [&](std::size_t i) { return one.scene.all_hits(rays[i]); });
    compare([&](Scene& scene, auto& out) { scene.nearest(boxes, 5, out); }, Answers<Neighbor>(),
            [&](std::size_t i) { return one.scene.nearest(boxes[i], 5); });
    compare([&](Scene& scene, auto& out) { scene.first_hits(rays, out); }, Answers<RayHit>(),
            [&](std::size_t i) {
                const auto hit = one.scene.first_hit(rays[i]);
                return hit ? std::vector<RayHit>{*hit} : std::vector<RayHit>{};
            });
}

INSTANTIATE_TEST_SUITE_P(Kinds, SceneQueriesTest, ::testing::ValuesIn(all_kind_names()), param_name);

TEST(SceneQueries, OfAnEmptySceneFindNothing) {
    Scene scene;
    EXPECT_TRUE(scene.overlaps(Box3d{{0, 0, 0}, {1, 1, 1}}).empty());
    EXPECT_TRUE(scene.overlaps(Sphere{{0, 0, 0}, 1}).empty());
    EXPECT_FALSE(scene.first_hit({{0, 0, 0}, {1, 0, 0}}).has_value());
    EXPECT_TRUE(scene.all_hits({{0, 0, 0}, {1, 0, 0}}).empty());
    EXPECT_TRUE(scene.nearest(Box3d{{0, 0, 0}, {0, 0, 0}}, 3).empty());
}

TEST(SceneQueries, ARayThatOnlyTouchesHits) {
    Scene scene({1, Precision::float64});
    const std::vector<Box3d> boxes = {{{3, 1, 1}, {4, 2, 2}}, {{6, 2, 2}, {6, 2, 2}}, {{9, 3, 0}, {10, 3, 9}}};
    std::vector<ObjectId> ids(boxes.size());
    scene.add(Objects{boxes}, ids);
    // The ray runs along an edge of box 0, and through box 1, which is a point.
    EXPECT_EQ(scene.all_hits({{0, 2, 2}, {1, 0, 0}}), (std::vector<RayHit>{{0, 3}, {1, 6}}));
    // The ray enters box 0 at a corner, passes through box 1, and hits the border of box 2, which is flat.
    EXPECT_EQ(scene.all_hits({{0, 0, 0}, {3, 1, 1}}), (std::vector<RayHit>{{0, 1}, {1, 2}, {2, 3}}));
    // The first segment ends where box 0 begins. The second segment ends before box 0.
    EXPECT_EQ(scene.all_hits({{0, 1.5, 1.5}, {3, 0, 0}, 1}), (std::vector<RayHit>{{0, 1}}));
    EXPECT_TRUE(scene.all_hits({{0, 1.5, 1.5}, {2.5, 0, 0}, 1}).empty());
    // A ray away from the boxes hits nothing. A ray that starts inside a box hits this box at 0.
    EXPECT_TRUE(scene.all_hits({{0, 1.5, 1.5}, {-1, 0, 0}}).empty());
    EXPECT_EQ(scene.first_hit({{3.5, 1.5, 1.5}, {0, 0, -1}}), (RayHit{0, 0}));
}

/// Returns all points with integer coordinates at distance 27 from (0, 0, 0), in ascending order of their coordinates.
/// Each coordinate c becomes (c + moved) * 2^exponent.
std::vector<Box3d> points_of_a_sphere(int exponent, double moved) {
    std::vector<Box3d> points;
    for (int x = -27; x <= 27; ++x) {
        for (int y = -27; y <= 27; ++y) {
            for (int z = -27; z <= 27; ++z) {
                if (x * x + y * y + z * z != 27 * 27) continue;
                double at[3] = {double(x), double(y), double(z)};
                for (double& coordinate : at) coordinate = std::ldexp(coordinate + moved, exponent);
                points.push_back(point_box(at));
            }
        }
    }
    return points;
}

TEST(SceneQueries, ASphereAndTheNearestFindExactlyEqualDistances) {
    for (const int exponent : {0, -3, 40, -500, 500, -1074, 1000}) {
        for (const double moved : {0.0, 1000.0}) {
            std::vector<Box3d> points = points_of_a_sphere(exponent, moved);
            std::shuffle(points.begin(), points.end(), std::mt19937_64(7));
            Scene scene({1, Precision::float64});
            std::vector<ObjectId> ids(points.size());
            scene.add(Objects{points}, ids);
            scene.step();
            const double centre = std::ldexp(moved, exponent), radius = std::ldexp(27, exponent);
            EXPECT_EQ(scene.overlaps(Sphere{{centre, centre, centre}, radius}).size(), points.size()) << exponent;
            EXPECT_TRUE(scene.overlaps(Sphere{{centre, centre, centre}, std::nextafter(radius, 0)}).empty());
            for (const std::size_t count : {std::size_t(1), std::size_t(5), points.size()}) {
                std::vector<Neighbor> expected;
                for (std::uint32_t i = 0; i < count; ++i) expected.push_back({i, radius});
                EXPECT_EQ(scene.nearest({{centre, centre, centre}, {centre, centre, centre}}, count), expected);
            }
        }
    }
}

TEST(SceneQueries, TheNearestOfEqualRoundedDistancesComesFirst) {
    // Both distances are reported as 1, but box 0 is 2^-81 farther.
    const std::vector<Box3d> boxes = {{{1, 0x1p-40, 0}, {1, 0x1p-40, 0}}, {{0, 1, 0}, {0, 1, 0}}};
    Scene scene({1, Precision::float64});
    std::vector<ObjectId> ids(boxes.size());
    scene.add(Objects{boxes}, ids);
    scene.step();
    const Box3d place{{0, 0, 0}, {0, 0, 0}};
    EXPECT_EQ(scene.nearest(place, 1), (std::vector<Neighbor>{{1, 1}}));
    EXPECT_EQ(scene.nearest(place, 2), (std::vector<Neighbor>{{1, 1}, {0, 1}}));
}

TEST(SceneQueries, NearestObjectsAreWithinTheLimit) {
    const std::vector<Box3d> boxes = {{{1, 0, 0}, {2, 0, 0}}, {{-3, 0, 0}, {-3, 0, 0}}, {{0, 0, 0}, {0, 0, 0}}};
    Scene scene({1, Precision::float64});
    std::vector<ObjectId> ids(boxes.size());
    scene.add(Objects{boxes}, ids);
    const Box3d place{{0, 0, 0}, {0, 0, 0}};
    const auto nearest = [&](std::size_t count, double within) {
        Answers<Neighbor> answers;
        scene.nearest(std::span(&place, 1), NearestLimits{count, within}, answers);
        return answers.all;
    };
    const std::vector<Neighbor> all = {{2, 0}, {0, 1}, {1, 3}};
    for (std::size_t i = 0; i < 2; ++i) {  // without a step, and after a step
        EXPECT_EQ(nearest(5, std::numeric_limits<double>::infinity()), all);
        EXPECT_EQ(nearest(5, 3), all);
        EXPECT_EQ(nearest(5, std::nextafter(3, 0)), std::vector<Neighbor>(all.begin(), all.begin() + 2));
        EXPECT_EQ(nearest(1, 3), std::vector<Neighbor>(all.begin(), all.begin() + 1));
        EXPECT_EQ(nearest(5, 0), std::vector<Neighbor>(all.begin(), all.begin() + 1));
        EXPECT_TRUE(nearest(0, 3).empty());
        scene.step();
    }
}

TEST_P(SceneQueriesTest, EndAfterAStopRequest) {
    Pool pool(GetParam(), 300, 2);
    const std::vector<Box3d> boxes = widened(make_boxes(GetParam(), 20, 22));
    const std::vector<Sphere> spheres(20, {{0, 0, 0}, 1});
    const std::vector<Ray> rays(20, {{0, 0, 0}, {1, 1, 1}});
    const auto check = [&](auto answers, auto ask) {
        (void)error_of(ErrorCode::cancelled, [&] { ask(answers, requested_stop()); });
        ask(answers, std::stop_token());
        EXPECT_EQ(answers.ends.size(), 20U);
    };
    constexpr std::uint32_t groups = Scene::all_groups;
    Scene& scene = pool.scene;
    check(Answers<std::uint32_t>(), [&](auto& answers, auto stop) { scene.overlaps(boxes, answers, groups, stop); });
    check(Answers<std::uint32_t>(), [&](auto& answers, auto stop) { scene.overlaps(spheres, answers, groups, stop); });
    check(Answers<RayHit>(), [&](auto& answers, auto stop) { scene.first_hits(rays, answers, groups, stop); });
    check(Answers<RayHit>(), [&](auto& answers, auto stop) { scene.all_hits(rays, answers, groups, stop); });
    check(Answers<Neighbor>(), [&](auto& answers, auto stop) { scene.nearest(boxes, {2}, answers, groups, stop); });
    QueryModel(pool.model, scene, 1).check();
}

/// Returns the bytes of memory that the program has allocated.
std::size_t allocated_bytes() {
    const struct mallinfo2 now = ::mallinfo2();
    return now.uordblks + now.hblkhd;
}

TEST(SceneQueries, LargeBuffersAreFreed) {
    Scene scene({2});
    const std::vector<Box3f> boxes(1000, Box3f{{0, 0, 0}, {1, 1, 1}});
    std::vector<ObjectId> ids(boxes.size());
    scene.add(Objects{boxes}, ids);
    scene.step();
    const std::vector<Box3d> queries(8000, Box3d{{0, 0, 0}, {1, 1, 1}});
    {
        Answers<std::uint32_t> answers;  // the other memory of queries grows here
        scene.overlaps(std::span(queries).first(100), answers);
    }
    const std::size_t before = allocated_bytes();
    {
        Answers<std::uint32_t> answers;
        scene.overlaps(queries, answers);
        ASSERT_EQ(answers.all.size(), 8'000'000U);
    }
    EXPECT_LT(allocated_bytes(), before + 4 * tuning().scene.max_kept_answers);
}

TEST(SceneQueries, BadOnesAreRefused) {
    constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    Scene scene;
    const auto refused = [](auto&& ask) { return error_of(ErrorCode::bad_input, ask); };
    const std::string what = "query 0 of the call is not valid";
    EXPECT_EQ(refused([&] { (void)scene.overlaps(Box3d{{1, 0, 0}, {0, 1, 1}}); }), what);
    EXPECT_EQ(refused([&] { (void)scene.overlaps(Box3d{{0, 0, 0}, {infinity, 1, 1}}); }), what);
    EXPECT_EQ(refused([&] { (void)scene.overlaps(Sphere{{0, 0, 0}, -1}); }), what);
    EXPECT_EQ(refused([&] { (void)scene.overlaps(Sphere{{0, nan, 0}, 1}); }), what);
    EXPECT_EQ(refused([&] { (void)scene.first_hit({{0, 0, 0}, {0, 0, 0}}); }), what);
    EXPECT_EQ(refused([&] { (void)scene.all_hits({{0, 0, 0}, {1, infinity, 0}}); }), what);
    EXPECT_EQ(refused([&] { (void)scene.all_hits({{0, 0, 0}, {1, 0, 0}, nan}); }), what);
    EXPECT_EQ(refused([&] { (void)scene.nearest(Box3d{{0, 0, nan}, {0, 0, 1}}, 1); }), what);
    Answers<Neighbor> answers;
    const Box3d place{{0, 0, 0}, {1, 1, 1}};
    for (const double within : {-1.0, nan}) {
        EXPECT_EQ(refused([&] {
                      scene.nearest(std::span(&place, 1), NearestLimits{1, within}, answers);
                  }),
                  "NearestLimits::within must be a number of at least 0");
    }
}

}  // namespace
}  // namespace octopair::test
