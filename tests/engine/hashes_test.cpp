// Tests reproducibility. The ascending pairs of every kind of scene match pinned hashes. Octal pairs do not depend on
// the number of threads.
#include <gtest/gtest.h>

#include "baselines/baselines.hpp"
#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/calls.hpp"
#include "support/compare.hpp"
#include "support/hash.hpp"
#include "support/kinds.hpp"
#include "support/pinned.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class EngineHashes : public ::testing::TestWithParam<std::string> {
protected:
    const Pinned& expected() const { return pinned_scene(GetParam()); }
    std::vector<Box3f> scene() const { return samples::make_scene(GetParam(), expected().objects, 1); }
};

TEST_P(EngineHashes, AscendingIsAsPinned) {
    const auto boxes = scene();
    for (const unsigned threads : {1u, 2u, 3u, 8u, 16u}) {
        Hash hash;
        Options options{.buffer_bytes = 64 << 20};
        const Summary summary = make_local_engine(threads)->stream_pairs(
            Objects{boxes}, [&](std::span<const Pair> batch) { hash.add(batch); }, options);
        EXPECT_EQ(summary.pairs, expected().pairs) << threads << " threads";
        EXPECT_EQ(hash.value(), expected().pair_hash) << threads << " threads";
    }
}

TEST_P(EngineHashes, Float64IsAsPinnedToo) {
    const auto boxes = widened(scene());
    PairList list;
    make_local_engine(2)->find_pairs({boxes}, list);
    Hash hash;
    for (const auto chunk : list.chunks()) hash.add(chunk);
    EXPECT_EQ(hash.value(), expected().pair_hash);
}

TEST_P(EngineHashes, OctalIsTheSameForAnyThreads) {
    const auto boxes = scene();
    std::vector<Pair> first;
    for (const unsigned threads : {1u, 2u, 3u, 8u, 16u}) {
        Options options{.order = Order::octal};
        const std::vector<Pair> pairs = listed_pairs(*make_local_engine(threads), {boxes}, options);
        EXPECT_EQ(pairs.size(), expected().pairs);
        if (threads == 1) first = pairs;
        EXPECT_TRUE(same_sequence(pairs, first)) << threads << " threads";
    }
    EXPECT_EQ(hash_of(baselines::ascending(first)), expected().pair_hash);
}

INSTANTIATE_TEST_SUITE_P(, EngineHashes, ::testing::ValuesIn(sample_kind_names()), param_name);

TEST(EngineHashesTable, HasEveryKind) { EXPECT_EQ(std::size(pinned_scenes), sample_kind_names().size()); }

}  // namespace
}  // namespace octopair::test
