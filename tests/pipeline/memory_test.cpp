// Tests that the size of a batch bounds memory, not the number of candidate pairs.
#include <gtest/gtest.h>

#include "octopair/octopair.hpp"
#include "pipeline/flow.hpp"
#include "support/peak_memory.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Runs in a separate process, so that the peak memory of a test does not hide that of another test.
class PipelineMemory : public ::testing::TestWithParam<Order> {};
INSTANTIATE_TEST_SUITE_P(, PipelineMemory, ::testing::Values(Order::octal, Order::ascending),
                         [](const auto& drawn) { return drawn.param == Order::octal ? "Octal" : "Ascending"; });

TEST_P(PipelineMemory, IsThatOfABatch) {
    constexpr std::uint64_t objects = scaled(7000, 5);
    constexpr std::uint64_t pairs = objects * (objects - 1) / 2;  // 24 million; with their findings 5 GB
    const auto boxes = samples::make_scene("coincident", objects, 1);
    Pipeline pipeline(2);
    pipeline.add(std::make_unique<LotFilter>(~std::uint64_t(0)));
    const std::uint64_t before = peak_rss();
    Options options{.order = GetParam(), .buffer_bytes = 16 << 20};
    std::uint64_t learned = 0;
    const PipelineSummary summary = pipeline.run(
        *make_local_engine(2), all_of(boxes), [&](const Batch& batch) { learned += batch.findings().size(); }, options);
    EXPECT_EQ(summary.collisions, pairs);
    EXPECT_EQ(learned, pairs);
    if (!sanitized) {
        EXPECT_LT(peak_rss() - before, 64u << 20);
    }
}

}  // namespace
}  // namespace octopair::test
