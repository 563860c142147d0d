// Tests ascending order of pairs, for any distribution of pairs over threads and any number of pages.
#include "engine/threads/team_output.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <vector>

#include "engine/bucket_sort.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

/// Returns distinct pairs of objects below `objects` in random order. `crowd` of the pairs have the same `a`.
std::vector<Pair> random_pairs(std::size_t count, std::uint32_t objects, std::size_t crowd) {
    std::mt19937_64 random(count + objects);
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < count; ++i) {
        const auto a = std::uint32_t(random() % objects), b = std::uint32_t(random() % objects);
        if (a != b) pairs.push_back({std::min(a, b), std::max(a, b)});
    }
    for (std::uint32_t i = 0; i < crowd; ++i) pairs.push_back({objects / 3, objects / 3 + 1 + i});
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    std::shuffle(pairs.begin(), pairs.end(), random);
    return pairs;
}

/// Writes `pairs` in 100 shares and returns the sorted list.
std::vector<Pair> sorted_by(unsigned threads, const std::vector<Pair>& pairs, const AscendingBounds& bounds) {
    Team team(threads);
    PairList list;
    std::uint64_t wanted = 0;
    std::atomic<std::uint64_t> sorted = 0;
    const auto write_pairs = [&](Executor& executor) {
        executor.for_each_writing(100, [&](std::size_t i, ShareWriter& writer) {
            const std::size_t begin = pairs.size() * i / 100, end = pairs.size() * (i + 1) / 100;
            writer.write(std::span(pairs).subspan(begin, end - begin));
        });
    };
    list_ascending_pairs(team, detail::storage_of(list), bounds, write_pairs,
                         {.begin = [&](std::uint64_t found) { wanted = found; },
                          .sorted = [&](std::uint64_t of_bucket) { sorted += of_bucket; }});
    EXPECT_EQ(sorted, wanted);
    EXPECT_EQ(list.size(), wanted);
    EXPECT_EQ(list.size(), list.to_vector().size());
    return list.to_vector();
}

class Ascending : public ::testing::TestWithParam<unsigned> {};

TEST_P(Ascending, KeysOfAnyWidth) {
    for (const std::uint32_t objects : {2u, 1000u, 1u << 16, 1u << 22, ~0u}) {
        std::vector<Pair> pairs = random_pairs(100'000, objects, 0);
        const auto found = sorted_by(GetParam(), pairs, {{0, objects}, objects});
        std::sort(pairs.begin(), pairs.end());
        EXPECT_TRUE(same_sequence(found, pairs)) << objects;
    }
}

// A pair that is there twice is a fault of the search. A check of the result must be able to see it.
TEST_P(Ascending, KeepsDoubledPairs) {
    for (const std::uint32_t objects : {40u, 1000u, 1u << 20}) {
        std::vector<Pair> pairs = random_pairs(20'000, objects, 0);
        for (std::size_t i = 0, single = pairs.size(); i < single; i += 7) pairs.push_back(pairs[i]);
        const auto found = sorted_by(GetParam(), pairs, {{0, objects}, objects});
        std::sort(pairs.begin(), pairs.end());
        EXPECT_TRUE(same_sequence(found, pairs)) << objects;
    }
}

TEST_P(Ascending, BucketsTooLargeToSortAtOnce) {
    std::vector<Pair> pairs = random_pairs(10'000, 5'000'000, 600'000);
    const auto found = sorted_by(GetParam(), pairs, {{0, 5'000'000}, 5'000'000});
    std::sort(pairs.begin(), pairs.end());
    EXPECT_TRUE(same_sequence(found, pairs));
}

/// Slotted rows count up to 65,535 pairs in 16 bits. The pairs of a bucket may all have the same `a`.
TEST_P(Ascending, BucketsAtTheLimitOfSlottedRows) {
    const std::uint32_t objects = 1 << 23;  // so that a bucket has many rows
    for (const std::uint32_t count : {0xFFFEu, 0xFFFFu, 0x10000u, 0x10001u}) {
        for (const std::uint32_t rows : {1u, 5000u}) {
            std::vector<Pair> pairs;
            for (std::uint32_t i = count; i-- > 0;) pairs.push_back({i % rows, 10'000 + i});
            const auto found = sorted_by(GetParam(), pairs, {{0, objects}, objects});
            std::sort(pairs.begin(), pairs.end());
            EXPECT_TRUE(same_sequence(found, pairs)) << count << " pairs of " << rows << " rows";
        }
    }
}

TEST_P(Ascending, OnlyTheRowsAskedFor) {
    std::vector<Pair> pairs = random_pairs(100'000, 1'000'000, 1000);
    const auto found = sorted_by(GetParam(), pairs, {{250'000, 600'001}, 1'000'000});
    std::erase_if(pairs, [](const Pair& pair) { return pair.a < 250'000 || pair.a > 600'000; });
    std::sort(pairs.begin(), pairs.end());
    EXPECT_TRUE(same_sequence(found, pairs));
}

TEST_P(Ascending, NoPairs) { EXPECT_TRUE(sorted_by(GetParam(), {}, {{0, 0}, 0}).empty()); }

TEST_P(Ascending, TooManyForTheBudget) {
    const std::vector<Pair> pairs = random_pairs(100'000, 1000, 0);
    EXPECT_THROW(sorted_by(GetParam(), pairs, {{0, 1000}, 1000, pairs.size() - page_pairs()}), OverBudget);
    EXPECT_EQ(sorted_by(GetParam(), pairs, {{0, 1000}, 1000, pairs.size() * 2}).size(), pairs.size());
}

INSTANTIATE_TEST_SUITE_P(Threads, Ascending, ::testing::Values(1, 2, 8));

}  // namespace
}  // namespace octopair::test
