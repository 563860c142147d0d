// Tests guarantees of the public calls other than the pairs: reuse, the short form, summaries, progress and threads.
#include <gtest/gtest.h>

#include <thread>

#include "baselines/baselines.hpp"
#include "engine/jobs.hpp"
#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/compare.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

TEST(EngineCalls, ShortFormIsAscending) {
    const auto boxes = samples::make_scene("dense", 2000, 1);
    EXPECT_EQ(find_pairs(boxes), baselines::oracle_pairs(objects_of(boxes)));
    const std::vector<Box3d> doubles = {{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}};
    EXPECT_EQ(find_pairs(doubles), (std::vector<Pair>{{0, 1}}));
}

TEST(EngineCalls, ListIsReusedForSmallerAndLargerResults) {
    const auto engine = make_local_engine(2);
    PairList list;
    for (const std::uint64_t n : {3000, 10, 20'000, 0, 1, 5000}) {
        const auto boxes = samples::make_scene("dense", n, n);
        engine->find_pairs(objects_of(boxes), list);
        EXPECT_TRUE(same_bytes(list.to_vector(), baselines::ascending(baselines::lbvh_pairs(boxes)))) << n;
        std::uint64_t in_chunks = 0;
        for (const auto chunk : list.chunks()) in_chunks += chunk.size();
        EXPECT_EQ(in_chunks, list.size());
    }
}

TEST(EngineCalls, ListMoves) {
    const auto boxes = samples::make_scene("dense", 2000, 1);
    PairList list;
    make_local_engine(1)->find_pairs(objects_of(boxes), list);
    const auto pairs = list.to_vector();
    PairList moved = std::move(list);
    EXPECT_EQ(moved.to_vector(), pairs);
    PairList assigned;
    assigned = std::move(moved);
    EXPECT_EQ(assigned.to_vector(), pairs);
}

TEST(EngineCalls, ListOutlivesItsEngine) {
    const auto boxes = samples::make_scene("dense", 20'000, 1);
    PairList list;
    make_local_engine(2)->find_pairs(objects_of(boxes), list);
    EXPECT_TRUE(same_bytes(list.to_vector(), baselines::ascending(baselines::lbvh_pairs(boxes))));
}

TEST(EngineCalls, OneEngineFromManyThreads) {
    const auto boxes = samples::make_scene("mixed", 3000, 1);
    const auto expected = baselines::oracle_pairs(objects_of(boxes));
    const auto engine = make_local_engine(2);
    std::vector<std::vector<Pair>> found(6);
    {
        std::vector<std::jthread> callers;
        for (auto& result : found) {
            callers.emplace_back([&] {
                PairList list;
                for (int i = 0; i < 5; ++i) engine->find_pairs(objects_of(boxes), list);
                result = list.to_vector();
            });
        }
    }
    for (const auto& result : found) EXPECT_TRUE(same_bytes(result, expected));
}

TEST(EngineCalls, EnginesSideBySide) {
    const auto boxes = samples::make_scene("clustered", 20'000, 1);
    const auto expected = baselines::ascending(baselines::lbvh_pairs(boxes));
    std::vector<std::vector<Pair>> found(4);
    {
        std::vector<std::jthread> callers;
        for (std::size_t i = 0; i < found.size(); ++i) {
            callers.emplace_back([&, i] {
                PairList list;
                make_local_engine(unsigned(i) + 1)->find_pairs(objects_of(boxes), list);
                found[i] = list.to_vector();
            });
        }
    }
    for (const auto& result : found) EXPECT_TRUE(same_bytes(result, expected));
}

TEST(EngineCalls, SummaryAddsUp) {
    const auto boxes = samples::make_scene("mixed", scaled(200'000, 10), 1);
    PairList list;
    const Summary summary = make_local_engine(2)->find_pairs(objects_of(boxes), list);
    EXPECT_EQ(summary.pairs, list.size());
    EXPECT_GE(summary.entries, boxes.size());
    EXPECT_LE(summary.entries, 8 * boxes.size());
    const StepSeconds& steps = summary.steps;
    for (const double step : {steps.encode, steps.scatter, steps.count, steps.scan}) EXPECT_GE(step, 0);
    EXPECT_GT(steps.encode + steps.scatter + steps.count + steps.scan, 0);
    EXPECT_LE(steps.encode + steps.scatter + steps.count + steps.scan, summary.seconds * 1.01);
}

TEST(EngineCalls, LimitsAroundTheNumberOfPairs) {
    const auto boxes = samples::make_scene("dense", 5000, 1);
    const auto engine = make_local_engine(2);
    for (const Order order : {Order::ascending, Order::octal}) {
        PairList list;
        Options options{.order = order};
        engine->find_pairs(objects_of(boxes), list, options);
        const auto all = list.to_vector();
        for (const std::uint64_t limit :
             {std::uint64_t(0), std::uint64_t(1), all.size() - 1, all.size(), all.size() + 1, ~std::uint64_t(0)}) {
            options.limit = limit;
            const Summary summary = engine->find_pairs(objects_of(boxes), list, options);
            EXPECT_EQ(summary.truncated, limit < all.size()) << limit;
            const auto kept = std::ptrdiff_t(std::min<std::uint64_t>(limit, all.size()));
            EXPECT_TRUE(same_bytes(list.to_vector(), {all.begin(), all.begin() + kept})) << limit;
        }
    }
}

TEST(EngineCalls, StreamsWithLimitsThroughASmallBuffer) {
    const auto boxes = samples::make_scene("dense", scaled(100'000, 2), 1);
    const auto engine = make_local_engine(2);
    for (const Order order : {Order::ascending, Order::octal}) {
        Options options{.order = order};
        auto expected = listed_pairs(*engine, objects_of(boxes), options);
        options.buffer_bytes = 1;
        options.limit = expected.size() * 2 / 3;
        expected.resize(*options.limit);
        std::vector<Pair> found;
        int batches = 0;
        const Summary summary = engine->stream_pairs(
            objects_of(boxes),
            [&](std::span<const Pair> batch) {
                ++batches;
                EXPECT_LE(batch.size_bytes(), 1u << 20);
                found.insert(found.end(), batch.begin(), batch.end());
            },
            options);
        EXPECT_TRUE(summary.truncated);
        EXPECT_EQ(summary.pairs, expected.size());
        EXPECT_GT(batches, 1);
        EXPECT_TRUE(same_bytes(found, expected));
    }
}

TEST(EngineCalls, SinkIsCalledOnTheCallersThread) {
    const auto boxes = samples::make_scene("dense", 50'000, 1);
    Options options{.buffer_bytes = 0};
    for (const Order order : {Order::ascending, Order::octal}) {
        options.order = order;
        make_local_engine(4)->stream_pairs(
            objects_of(boxes),
            [caller = std::this_thread::get_id()](std::span<const Pair> batch) {
                EXPECT_FALSE(batch.empty());
                EXPECT_EQ(std::this_thread::get_id(), caller);
            },
            options);
    }
}

TEST(EngineCalls, ASinkMayUseAnotherEngine) {
    const auto boxes = samples::make_scene("dense", 20'000, 1);
    const auto inner = make_local_engine(2);
    std::uint64_t pairs = 0;
    make_local_engine(2)->stream_pairs(objects_of(boxes), [&](std::span<const Pair> batch) {
        pairs += batch.size();
        EXPECT_GT(inner->count_pairs(objects_of(boxes)), 0u);
    });
    EXPECT_EQ(pairs, inner->count_pairs(objects_of(boxes)));
}

/// Checks that progress never falls, stays within [0, 1] and ends at 1.
class ProgressRecord {
public:
    ProgressSink sink() {
        return [this](double done) {
            EXPECT_GE(done, last_);
            EXPECT_LE(done, 1.0);
            last_ = done;
            ++calls_;
        };
    }
    void expect_done(const std::string& what) const {
        EXPECT_EQ(last_, 1.0) << what;
        EXPECT_GE(calls_, 1) << what;
    }

private:
    double last_ = 0;
    int calls_ = 0;
};

TEST(EngineCalls, ProgressNeverFallsAndEndsAtOne) {
    for (const std::string kind : {"uniform", "rods", "coincident"}) {
        for (const std::uint64_t n : {std::uint64_t(0), std::uint64_t(100), scaled(2000, 2)}) {
            const auto boxes = samples::make_scene(kind, n, 1);
            for (const Order order : {Order::ascending, Order::octal}) {
                const auto engine = make_local_engine(2);
                Options options{.order = order};
                PairList list;
                ProgressRecord listed, streamed, counted;
                options.progress = listed.sink();
                engine->find_pairs(objects_of(boxes), list, options);
                listed.expect_done(kind + " listed");
                options.progress = streamed.sink();
                options.buffer_bytes = 0;
                engine->stream_pairs(
                    objects_of(boxes), [](auto) {}, options);
                streamed.expect_done(kind + " streamed");
                options.progress = counted.sink();
                engine->count_pairs(objects_of(boxes), options);
                counted.expect_done(kind + " counted");
            }
        }
    }
}

TEST(EngineCalls, InputIsNotModified) {
    const auto boxes = samples::make_scene("mixed", 5000, 1);
    const auto before = boxes;
    find_pairs(boxes);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(boxes[i].min[axis], before[i].min[axis]);
            ASSERT_EQ(boxes[i].max[axis], before[i].max[axis]);
        }
    }
}

TEST(EngineCalls, ZeroThreadsAreOnePerCore) {
    const auto boxes = samples::make_scene("dense", 5000, 1);
    EXPECT_TRUE(same_bytes(listed_pairs(*make_local_engine(), objects_of(boxes)),
                           baselines::ascending(baselines::lbvh_pairs(boxes))));
}

}  // namespace
}  // namespace octopair::test
