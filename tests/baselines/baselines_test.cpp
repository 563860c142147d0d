// Tests that all baselines find exactly the pairs of the oracle.
#include "baselines/baselines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "baselines/paper_steps.hpp"
#include "samples/random.hpp"
#include "samples/scenes.hpp"
#include "support/calls.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::baselines {
namespace {

using test::same_pairs;

constexpr std::uint64_t scenes_per_kind = test::scaled(40, 4);

class Baselines : public ::testing::TestWithParam<std::string> {};

void expect_agreement(const std::vector<Box3f>& boxes) {
    const Objects objects{boxes};
    const std::vector<Pair> expected = oracle_pairs(objects);
    EXPECT_TRUE(same_pairs(naive_pairs(std::span<const Box3f>(boxes)), expected, {objects})) << "naive";
    for (unsigned axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(same_pairs(ascending(sweep_and_prune(boxes, axis)), expected, {objects})) << "sweep along " << axis;
    }
    const unsigned lbvh_threads = test::thread_sanitized ? 1 : 1 + unsigned(boxes.size() % 3);
    EXPECT_TRUE(same_pairs(ascending(lbvh_pairs(boxes, lbvh_threads)), expected, {objects})) << "LBVH";
    EXPECT_TRUE(same_pairs(ascending(ICollide().next_frame(boxes)), expected, {objects})) << "I-COLLIDE";
}

TEST_P(Baselines, AgreeWithTheOracle) {
    for (std::uint64_t i = 0; i < test::case_count(scenes_per_kind); ++i) {
        const std::uint64_t seed = test::case_seed(GetParam(), i);
        SCOPED_TRACE("replay with OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        expect_agreement(test::make_boxes(GetParam(), seed % 400, seed));
    }
}

TEST_P(Baselines, PaperAgreesForAnyLevelAndNumberOfSlaves) {
    for (std::uint64_t i = 0; i < test::case_count(scenes_per_kind); ++i) {
        const std::uint64_t seed = test::case_seed(GetParam(), i);
        SCOPED_TRACE("replay with OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        const std::vector<Box3f> boxes = test::make_boxes(GetParam(), seed % 100, seed);
        const Objects objects{boxes};
        const PaperSettings settings{unsigned(seed >> 8) % 5, 1 + unsigned(seed >> 16) % 3,
                                     1 + unsigned(seed >> 24) % 3, PaperSort(seed >> 32 & 1)};
        const PaperResult result = paper_pairs(boxes, settings);
        EXPECT_TRUE(same_pairs(result.pairs, oracle_pairs(objects), {objects}));
        EXPECT_GE(result.entries, boxes.size());
        EXPECT_GE(result.candidates, result.pairs.size());
    }
}

INSTANTIATE_TEST_SUITE_P(, Baselines, ::testing::ValuesIn(test::all_kind_names()), test::param_name);

TEST(BaselinesPaper, EntriesDoNotDependOnTheSlaves) {
    const auto boxes = samples::make_scene("mixed", 3000, 1);
    const PaperResult alone = paper_pairs(boxes, {5, 1, 1});
    for (const PaperSettings settings : {PaperSettings{5, 1, 2}, {5, 3, 1}, {5, 2, 4}}) {
        const PaperResult result = paper_pairs(boxes, settings);
        EXPECT_EQ(result.entries, alone.entries);
        EXPECT_EQ(result.candidates, alone.candidates);
        EXPECT_TRUE(test::same_bytes(result.pairs, alone.pairs));
    }
}

TEST(BaselinesPaper, BothSortsGiveTheSame) {
    for (const char* kind : {"uniform", "mixed", "world10"}) {
        const auto boxes = samples::make_scene(kind, 2000, 1);
        for (const unsigned level : {1u, 4u, 5u}) {
            const PaperResult standard = paper_pairs(boxes, {level, 2, 2, PaperSort::standard});
            const PaperResult radix = paper_pairs(boxes, {level, 2, 2, PaperSort::radix});
            EXPECT_EQ(radix.entries, standard.entries) << kind << ", level " << level;
            EXPECT_EQ(radix.candidates, standard.candidates) << kind << ", level " << level;
            EXPECT_TRUE(test::same_bytes(radix.pairs, standard.pairs)) << kind << ", level " << level;
        }
    }
}

/// Makes the entries of a slave, with codes on all levels up to `level`.
std::vector<PaperEntry> random_entries(unsigned level) {
    samples::RandomStream random(1, level);
    std::vector<PaperEntry> entries;
    for (std::uint32_t object = 0; object < 2000; ++object) {
        const auto cell = [&] { return std::uint32_t(random.below(1u << OctalCode::max_level)); };
        entries.emplace_back(OctalCode::from_cell({cell(), cell(), cell()}, unsigned(random.below(level + 1))), object);
    }
    return entries;
}

TEST(BaselinesPaper, BothSortsAgreeOnEveryLevel) {
    for (unsigned level = 0; level <= OctalCode::max_level; ++level) {
        std::vector<PaperEntry> standard = random_entries(level);
        std::vector<PaperEntry> radix = standard;
        sort_entries(standard, PaperSort::standard, level);
        sort_entries(radix, PaperSort::radix, level);
        EXPECT_EQ(radix, standard) << "level " << level;
        EXPECT_TRUE(std::is_sorted(radix.begin(), radix.end())) << "level " << level;
    }
}

TEST(BaselinesPaper, TheBestLevelIsAPossibleOne) {
    for (const std::uint64_t objects : {0, 1, 3000}) {
        const unsigned level = best_paper_level(samples::make_scene("uniform", objects, 1));
        EXPECT_GE(level, 1u) << objects;
        EXPECT_LE(level, OctalCode::max_level) << objects;
    }
    EXPECT_EQ(best_paper_level(samples::make_scene("uniform", 3000, 1), {}, test::requested_stop()), 4u);
}

TEST(BaselinesPaper, AnObjectThatFillsTheWorldHasOneCode) {
    const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}}};
    EXPECT_EQ(paper_pairs(std::span(boxes).first(1), {6}).entries, 1u);
    EXPECT_EQ(paper_pairs(boxes, {1}).entries, 2u);
}

TEST(BaselinesICollide, FollowsMovingScenes) {
    constexpr std::uint64_t objects = 1000;
    ICollide engine;
    std::vector<Box3f> frame;
    std::uint64_t frames = 0;
    samples::generate_scene({"brownian", objects, 3, 20}, [&](std::span<const Box3f> batch) {
        frame.insert(frame.end(), batch.begin(), batch.end());
        if (frame.size() < objects) return;
        const Objects all{frame};
        EXPECT_TRUE(same_pairs(ascending(engine.next_frame(frame)), oracle_pairs(all), {all})) << "frame " << frames;
        ++frames;
        frame.clear();
    });
    EXPECT_EQ(frames, 20u);
}

TEST(BaselinesICollide, FollowsLeapsAndChangesOfNumber) {
    ICollide engine;
    for (const std::string& kind : test::all_kind_names()) {
        for (const std::uint64_t objects : {200, 200, 150}) {
            const auto boxes = test::make_boxes(kind, objects, objects + kind.size());
            const Objects all{boxes};
            EXPECT_TRUE(same_pairs(ascending(engine.next_frame(boxes)), oracle_pairs(all), {all})) << kind;
        }
    }
}

TEST(BaselinesOracle, RuleHoldsToTheLastBit) {
    const float gap = 0x1p-10f;
    const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{1 + gap, 0, 0}, {2, 1, 1}}};
    const Objects objects{boxes};
    EXPECT_TRUE(oracle_pairs(objects).empty());
    EXPECT_EQ(oracle_pairs(objects, gap).size(), 1u);
    EXPECT_TRUE(oracle_pairs(objects, std::nextafter(double(gap), 0)).empty());
    const std::vector<double> padding = {gap / 2, gap / 4};
    const Objects padded{boxes, padding};
    EXPECT_TRUE(oracle_pairs(padded).empty());
    EXPECT_EQ(oracle_pairs(padded, gap / 4).size(), 1u);
    EXPECT_EQ(oracle_pairs_between(objects, padded, gap * 3 / 4), (std::vector<Pair>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
}

TEST(BaselinesOracle, BothPrecisionsOfNaiveAgree) {
    const auto boxes = samples::make_scene("dense", 500, 2);
    const auto doubles = test::widened(boxes);
    EXPECT_EQ(naive_pairs(std::span<const Box3f>(boxes)), naive_pairs(std::span<const Box3d>(doubles)));
}

}  // namespace
}  // namespace octopair::baselines
