// Tests results with more pairs than 32 bits count, in memory that does not grow with the number of pairs.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/kinds.hpp"
#include "support/peak_memory.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t pairs_of(std::uint64_t n) { return n * (n - 1) / 2; }

TEST(EngineLarge, CountsBeyond32Bits) {
    constexpr std::uint64_t objects = sanitized ? 20'000 : 92'683;
    static_assert(sanitized || pairs_of(objects) == 4'295'022'903);
    const auto boxes = samples::make_scene("coincident", objects, 1);
    const std::uint64_t before = peak_rss();
    for (const unsigned threads : {1u, 2u}) {
        EXPECT_EQ(make_local_engine(threads)->count_pairs({boxes}), pairs_of(objects));
    }
    if (!sanitized) {
        EXPECT_LT(peak_rss() - before, 100u << 20);
    }
}

TEST(EngineLarge, StreamsInBoundedMemory) {
    constexpr std::uint64_t objects = scaled(12'000, 4);
    const auto boxes = samples::make_scene("coincident", objects, 1);
    const std::uint64_t before = peak_rss();
    for (const Order order : {Order::octal, Order::ascending}) {
        Options options{.order = order, .buffer_bytes = 64 << 20};
        std::uint64_t pairs = 0;
        make_local_engine(2)->stream_pairs(
            Objects{boxes}, [&](std::span<const Pair> batch) { pairs += batch.size(); }, options);
        EXPECT_EQ(pairs, pairs_of(objects));
    }
    if (!sanitized) {
        EXPECT_LT(peak_rss() - before, 160u << 20);
    }
}

/// Tests one kind per process, so that the peak memory of a kind does not hide that of another kind.
class EngineMemory : public ::testing::TestWithParam<std::string> {};

std::vector<std::string> kinds_to_measure() {
    std::vector<std::string> names = sample_kind_names();
    std::erase(names, "coincident");  // 499,999,500,000 pairs
    return names;
}

INSTANTIATE_TEST_SUITE_P(, EngineMemory, ::testing::ValuesIn(kinds_to_measure()), param_name);

TEST_P(EngineMemory, EntriesAndBytesAnObjectAreBounded) {
    constexpr std::uint64_t objects = scaled(1'000'000, 20);
    const auto boxes = samples::make_scene(GetParam(), objects, 1);
    const Objects all{boxes};
    const std::uint64_t before = peak_rss();
    const auto engine = make_local_engine(2);
    engine->count_pairs(all);
    const double bytes = double(peak_rss() - before) / double(objects);
    RecordProperty("bytes_per_object", std::to_string(bytes));
    if (!sanitized) {
        EXPECT_LE(bytes, 44);
    }
    PairList list;
    Options options{.order = Order::octal};
    EXPECT_LE(engine->find_pairs(all, list, options).entries, 8 * objects);
}

}  // namespace
}  // namespace octopair::test
