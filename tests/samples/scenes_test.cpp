// Tests that scenes are identical on every machine and in every batch, and have the pairs that docs/scenes.md states.
#include "samples/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "baselines/baselines.hpp"
#include "octopair/error.hpp"
#include "samples/random.hpp"
#include "support/errors.hpp"
#include "support/hash.hpp"
#include "support/kinds.hpp"
#include "support/pinned.hpp"

namespace octopair::samples {
namespace {

std::vector<std::string> kind_names() {
    const auto kinds = scene_kinds();
    return {kinds.begin(), kinds.end()};
}

/// Returns the message of the usage error for `spec`.
std::string refusal(const SceneSpec& spec) {
    return test::error_of(ErrorCode::usage,
                          [&] { generate_scene(spec, [](auto) { ADD_FAILURE() << "a batch of a refused scene"; }); });
}

class Scenes : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(, Scenes, ::testing::ValuesIn(kind_names()), test::param_name);

TEST_P(Scenes, AreAsPinned) {
    const test::Pinned& pinned = test::pinned_scene(GetParam());
    EXPECT_EQ(test::hash_of(make_scene(GetParam(), pinned.objects, 1)), pinned.scene_hash);
}

TEST_P(Scenes, AreValidBoxesOfAnyNumber) {
    for (const std::uint64_t n : {0, 1, 2, 3, 9, 19, 20, 21, 1000}) {
        const auto boxes = make_scene(GetParam(), n, n);
        ASSERT_EQ(boxes.size(), n);
        for (const Box3f& box : boxes) {
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_TRUE(std::isfinite(box.min[axis]) && std::isfinite(box.max[axis]));
                ASSERT_LE(box.min[axis], box.max[axis]);
            }
        }
    }
}

TEST_P(Scenes, ComeInBoundedBatchesThatAddUp) {
    constexpr std::uint64_t objects = 20'001;
    test::Hash hash;
    std::uint64_t count = 0;
    generate_scene({GetParam(), objects, 5}, [&](std::span<const Box3f> batch) {
        EXPECT_FALSE(batch.empty());
        EXPECT_LE(batch.size_bytes(), 1u << 20);
        count += batch.size();
        hash.add(batch);
    });
    EXPECT_EQ(count, objects);
    EXPECT_EQ(hash.value(), test::hash_of(make_scene(GetParam(), objects, 5)));
}

TEST_P(Scenes, DependOnTheSeed) {
    EXPECT_NE(test::hash_of(make_scene(GetParam(), 1000, 1)), test::hash_of(make_scene(GetParam(), 1000, 2)));
}

TEST_P(Scenes, AreDescribed) {
    EXPECT_FALSE(scene_description(GetParam()).empty());
    EXPECT_EQ(scene_description(GetParam()).find('\n'), std::string_view::npos);
}

TEST_P(Scenes, HaveOneFrameUnlessTheyMove) {
    if (GetParam() != "brownian") {
        EXPECT_NE(refusal({GetParam(), 10, 1, 2}).find("do not move"), std::string::npos);
    }
}

TEST_P(Scenes, HaveThePairsTheyAreMadeFor) {
    const std::map<std::string, double> aims = {
        {"uniform", 0.5},  {"dense", 5},       {"mixed", 2.4},     {"clustered", 2.5}, {"flat", 0.75},
        {"world10", 10.5}, {"same-x", 0.5},    {"same-y", 0.5},    {"same-z", 0.5},    {"sheets-x", 0.4},
        {"sheets-y", 0.4}, {"sheets-z", 0.4},  {"rods", 2},        {"micro20", 0.55},  {"far-outlier", 0.5},
        {"brownian", 0.5}, {"plates-x", 1e-3}, {"plates-y", 1e-3}, {"plates-z", 1e-3}};
    if (GetParam() == "coincident") return;
    const auto boxes = make_scene(GetParam(), 20'000, 7);
    const double pairs = double(baselines::lbvh_pairs(boxes).size()) / double(boxes.size());
    EXPECT_GT(pairs, aims.at(GetParam()) * 0.75);
    EXPECT_LT(pairs, aims.at(GetParam()) * (aims.at(GetParam()) < 0.01 ? 2 : 1.2));
}

TEST(ScenesCoincident, IsAllTheSame) {
    const auto boxes = make_scene("coincident", 100, 3);
    EXPECT_EQ(baselines::lbvh_pairs(boxes).size(), 100u * 99 / 2);
}

TEST(ScenesMicro20, IsTwentySmallClusters) {
    std::vector<Box3f> centres;
    for (const Box3f& box : make_scene("micro20", 2000, 1)) {
        const bool known = std::any_of(centres.begin(), centres.end(), [&](const Box3f& centre) {
            return std::abs(centre.min[0] - box.min[0]) < 2e-5f && std::abs(centre.min[1] - box.min[1]) < 2e-5f;
        });
        if (!known) centres.push_back(box);
    }
    EXPECT_EQ(centres.size(), 20u);
}

TEST(ScenesBrownian, FramesMoveALittleFromTheFirst) {
    constexpr std::uint64_t objects = 10'000, frames = 5;
    std::vector<Box3f> all;
    generate_scene({"brownian", objects, 1, frames},
                   [&](std::span<const Box3f> batch) { all.insert(all.end(), batch.begin(), batch.end()); });
    ASSERT_EQ(all.size(), objects * frames);
    EXPECT_EQ(test::hash_of(std::vector(all.begin(), all.begin() + objects)),
              test::hash_of(make_scene("uniform", objects, 1)));
    const double side = double(all[0].max[0]) - double(all[0].min[0]);
    constexpr double rounding = 1e-6;  // of float32 in the unit cube
    for (std::size_t i = objects; i < all.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const double step = double(all[i].min[axis]) - double(all[i - objects].min[axis]);
            ASSERT_LE(std::abs(step), side / 8 + rounding);
            ASSERT_GE(all[i].min[axis], 0);
            ASSERT_LE(all[i].min[axis], 1);
        }
    }
    EXPECT_EQ(test::hash_of(all), 6252328568775321793u);
}

TEST(ScenesRefuse, WhatIsNoScene) {
    EXPECT_NE(refusal({"unform", 10, 1}).find("unform"), std::string::npos);
    EXPECT_NE(refusal({"unform", 10, 1}).find("far-outlier"), std::string::npos);
    EXPECT_NE(refusal({"uniform", 10, 1, 0}).find("frame"), std::string::npos);
    EXPECT_NE(refusal({"uniform", std::uint64_t(1) << 32, 1}).find("4294967296"), std::string::npos);
    EXPECT_THROW(scene_description(""), Error);
    EXPECT_THROW(scene_description("Uniform"), Error);
}

TEST(ScenesRandom, StreamsOfNeighboursShareNothing) {
    std::map<std::uint64_t, int> seen;
    for (std::uint64_t index = 0; index < 100; ++index) {
        RandomStream random(1, index);
        for (int i = 0; i < 100; ++i) ++seen[random.next()];
    }
    EXPECT_EQ(seen.size(), 10'000u);
}

TEST(ScenesRandom, NumbersAreInRangeWithTheirMoments) {
    RandomStream random(1, 1);
    double mean = 0, gaussian_square = 0;
    for (int i = 0; i < 100'000; ++i) {
        const double u = random.uniform();
        ASSERT_GE(u, 0);
        ASSERT_LT(u, 1);
        ASSERT_LT(random.below(7), 7u);
        mean += u / 100'000;
        const double g = random.gaussian();
        gaussian_square += g * g / 100'000;
    }
    EXPECT_NEAR(mean, 0.5, 0.005);
    EXPECT_NEAR(gaussian_square, 1, 0.02);
}

}  // namespace
}  // namespace octopair::samples
