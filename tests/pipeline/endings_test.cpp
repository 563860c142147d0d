// Tests calls that end early: exceptions of filters and sinks, and stop requests.
#include <gtest/gtest.h>

#include <atomic>
#include <new>

#include "octopair/octopair.hpp"
#include "pipeline/flow.hpp"
#include "support/calls.hpp"
#include "support/reentry.hpp"

namespace octopair::test {
namespace {

struct Ending {
    unsigned threads;
    Order order;
};

class Endings : public ::testing::TestWithParam<Ending> {
protected:
    Options options() const {
        Options options{.order = GetParam().order, .buffer_bytes = 1 << 20};
        return options;
    }

    const std::vector<Box3f> boxes_ = samples::make_scene("dense", 20'000, 1);
    const std::unique_ptr<Engine> engine_ = make_local_engine(2);
};

std::string ending_name_of(const ::testing::TestParamInfo<Ending>& info) {
    return std::to_string(info.param.threads) + (info.param.order == Order::octal ? "Octal" : "Ascending");
}

INSTANTIATE_TEST_SUITE_P(, Endings,
                         ::testing::Values(Ending{1, Order::octal}, Ending{1, Order::ascending},
                                           Ending{2, Order::octal}, Ending{2, Order::ascending},
                                           Ending{7, Order::octal}),
                         ending_name_of);

TEST_P(Endings, CallsOfTheEngineInFiltersAndSinksAreRefused) {
    const std::vector<Box3f> few = boxes_in_a_row(3);
    std::atomic<int> filtered = 0, taken = 0;
    Pipeline pipeline(GetParam().threads);
    pipeline.add(make_filter("calling", [&](Pair) {
        if (filtered++ % 1000 == 0) expect_calls_refused(*engine_);
        return true;
    }));
    const CollisionSink sink = [&](const Batch&) {
        if (taken++ % 1000 == 0) expect_calls_refused(*engine_);
        EXPECT_EQ(find_pairs(few).size(), 2u);  // of another engine
    };
    (void)pipeline.run(*engine_, all_of(boxes_), sink, options());
    EXPECT_GT(filtered, 0);
    EXPECT_GT(taken, 0);
    EXPECT_EQ(engine_->count_pairs(all_of(few)), 2u);
}

/// Tests that the output before an exception does not depend on threads.
TEST_P(Endings, FiltersThrowWhereTheirPairIs) {
    Options asked = options();
    const std::vector<Pair> pairs = find_pairs(boxes_, asked);
    for (const std::size_t place : {std::size_t(0), pairs.size() / 2, pairs.size() - 1}) {
        Pipeline pipeline(GetParam().threads);
        pipeline.add(make_filter("throwing", [bad = pairs[place]](Pair pair) {
            if (pair == bad) throw Error(ErrorCode::bad_input, "a bad pair");
            return true;
        }));
        Outcome found;
        const auto run = [&] { pipeline.run(*engine_, all_of(boxes_), into(found), asked); };
        EXPECT_EQ(error_of(ErrorCode::bad_input, run), "a bad pair");
        EXPECT_LE(found.pairs.size(), place);
        EXPECT_TRUE(std::equal(found.pairs.begin(), found.pairs.end(), pairs.begin()));
        EXPECT_LT(place - found.pairs.size(), 4096u);  // at most the block of the bad pair is lost
    }
}

TEST_P(Endings, WhatTheSinkThrowsReachesTheCaller) {
    Pipeline pipeline(GetParam().threads);
    pipeline.add(std::make_unique<LotFilter>(5));
    std::size_t calls = 0;
    const CollisionSink sink = [&](const Batch&) {
        if (++calls == 3) throw 3;
    };
    EXPECT_THROW(pipeline.run(*engine_, all_of(boxes_), sink, options()), int);
    EXPECT_EQ(calls, 3u);
    // The pipeline and the engine can be used again.
    calls = 10;
    EXPECT_EQ(pipeline.run(*engine_, all_of(boxes_), sink, options()).search.pairs,
              engine_->count_pairs(all_of(boxes_)));
}

TEST_P(Endings, WantOfMemoryIsAnError) {
    Pipeline pipeline(GetParam().threads);
    pipeline.add(make_filter("hungry", [](Pair) -> bool { throw std::bad_alloc(); }));
    (void)error_of(ErrorCode::resource_limit, [&] { pipeline.run(*engine_, all_of(boxes_), {}, options()); });
}

TEST_P(Endings, WhatTheEngineThrowsReachesTheCaller) {
    std::vector<Box3f> boxes = boxes_;
    boxes[77].min[1] = 1e30F;
    Pipeline pipeline(GetParam().threads);
    pipeline.add(std::make_unique<LotFilter>(5));
    expect_error(ErrorCode::bad_input, "77", [&] { pipeline.run(*engine_, all_of(boxes), {}, options()); });
}

/// Tests stop requests during a call. timing_test.cpp tests how soon the call ends.
TEST_P(Endings, RequestsDuringACallHold) {
    std::stop_source source;
    Pipeline pipeline(GetParam().threads);
    std::atomic<std::uint64_t> seen = 0;
    pipeline.add(make_filter("asking", [&](Pair) {
        if (++seen == 10'000) source.request_stop();
        return true;
    }));
    std::uint64_t came_out = 0;
    const CollisionSink sink = [&](const Batch& batch) { came_out += batch.pairs().size(); };
    (void)error_of(ErrorCode::cancelled,
                   [&] { pipeline.run(*engine_, all_of(boxes_), sink, options(), source.get_token()); });
    EXPECT_LT(came_out, engine_->count_pairs(all_of(boxes_)));
}

TEST_P(Endings, ARequestDuringTheLastPairHolds) {
    std::stop_source source;
    Pipeline pipeline(GetParam().threads);
    std::atomic<std::uint64_t> seen = 0;
    pipeline.add(make_filter("all", [](Pair) { return true; }));
    const std::uint64_t all = pipeline.run(*engine_, all_of(boxes_), {}, options()).collisions;
    ASSERT_GT(all, 0u);
    pipeline.add(make_filter("last", [&](Pair) {
        if (++seen == all) source.request_stop();
        return true;
    }));
    (void)error_of(ErrorCode::cancelled,
                   [&] { pipeline.run(*engine_, all_of(boxes_), {}, options(), source.get_token()); });
    EXPECT_EQ(seen, all);
}

TEST_P(Endings, ARequestMadeBeforeTheCallHolds) {
    Pipeline pipeline(GetParam().threads);
    pipeline.add(std::make_unique<LotFilter>(5));
    (void)error_of(ErrorCode::cancelled,
                   [&] { pipeline.run(*engine_, all_of(boxes_), {}, options(), requested_stop()); });
}

}  // namespace
}  // namespace octopair::test
