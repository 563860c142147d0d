// Tests that workers give the same bytes as threads: pinned hashes of every kind of scene, for several numbers of
// workers.
#include <gtest/gtest.h>

#include "octopair/octopair.hpp"
#include "octopair/processes.hpp"
#include "samples/scenes.hpp"
#include "support/hash.hpp"
#include "support/kinds.hpp"
#include "support/pinned.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

struct Found {
    std::uint64_t pairs = 0, hash = 0;
    bool operator==(const Found&) const = default;
};

class WorkerHashes : public ::testing::TestWithParam<std::string> {
protected:
    Found streamed(Engine& engine, Order order) const {
        Options options{.order = order, .buffer_bytes = 64 << 20};
        Hash hash;
        const Summary summary = engine.stream_pairs(
            objects(), [&](std::span<const Pair> batch) { hash.add(batch); }, options);
        return {summary.pairs, hash.value()};
    }
    Found listed(Engine& engine, Order order) const {
        Options options{.order = order};
        PairList list;
        (void)engine.find_pairs(objects(), list, options);
        Hash hash;
        for (const auto chunk : list.chunks()) hash.add(chunk);
        return {list.size(), hash.value()};
    }
    Objects objects() const { return {boxes_, {}}; }

    const Pinned& pinned_ = pinned_scene(GetParam());
    const std::vector<Box3f> boxes_ = samples::make_scene(GetParam(), pinned_.objects, 1);
};

TEST_P(WorkerHashes, AreThoseOfThreads) {
    const auto local = make_local_engine(2);
    const Found octal = listed(*local, Order::octal);
    const Found ascending{pinned_.pairs, pinned_.pair_hash};
    const bool many = pinned_.pairs > 1'000'000;
    for (const unsigned workers : {1u, 2u, 3u, 5u}) {
        if (many && workers != 2 && (sanitized || workers != 5)) continue;
        SCOPED_TRACE(std::to_string(workers) + " workers");
        const auto engine = make_process_engine(workers);
        EXPECT_EQ(listed(*engine, Order::ascending), ascending);
        EXPECT_EQ(streamed(*engine, Order::ascending), ascending);
        EXPECT_EQ(listed(*engine, Order::octal), octal);
        EXPECT_EQ(streamed(*engine, Order::octal), octal);
        EXPECT_EQ(engine->count_pairs(objects()), pinned_.pairs);
    }
}

INSTANTIATE_TEST_SUITE_P(, WorkerHashes, ::testing::ValuesIn(sample_kind_names()), param_name);

}  // namespace
}  // namespace octopair::test
