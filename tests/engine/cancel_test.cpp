// Tests that a stop request ends any call within 200 ms.
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <thread>

#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/calls.hpp"
#include "support/cancel_time.hpp"
#include "support/errors.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;

class Cancel : public ::testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Threads, Cancel, ::testing::Values(1u, 2u, 8u));

/// Cancels a count and a stream of the pairs of `boxes` in each order. Expects that the engine works afterwards.
void expect_all_cancelled(const std::vector<Box3f>& boxes, unsigned threads, milliseconds delay, bool may_finish) {
    const Objects objects{boxes};
    const auto engine = make_local_engine(threads);
    const auto few = samples::make_scene("dense", 100, 1);
    const std::uint64_t few_pairs = find_pairs(few).size();
    PairList list;
    for (const Order order : {Order::octal, Order::ascending}) {
        SCOPED_TRACE("order " + std::to_string(int(order)));
        Options options{.order = order, .buffer_bytes = 64 << 20};
        expect_cancelled([&](std::stop_token stop) { engine->count_pairs(objects, options, stop); }, delay, may_finish);
        expect_cancelled(
            [&](std::stop_token stop) {
                engine->stream_pairs(
                    objects, [](auto) {}, options, stop);
            },
            delay, may_finish);
        EXPECT_EQ(engine->find_pairs({few}, list, options).pairs, few_pairs);
    }
}

TEST_P(Cancel, InOneCrowdedOctant) {
    const auto boxes = samples::make_scene("coincident", 300'000, 1);
    for (const int delay : {0, 20, 150}) {
        SCOPED_TRACE(delay);
        expect_all_cancelled(boxes, GetParam(), milliseconds(delay), false);
    }
}

TEST_P(Cancel, InAJoinOfOneCrowd) {
    const auto boxes = samples::make_scene("coincident", 300'000, 1);
    const Objects objects{boxes};
    const auto engine = make_local_engine(GetParam());
    expect_cancelled(
        [&](std::stop_token stop) {
            engine->count_pairs(Join{objects, objects}, {}, stop);
        },
        milliseconds(50), false);
}

TEST_P(Cancel, AtAnyMomentOfALargeScene) {
    for (const char* kind : {"dense", "rods", "sheets-z"}) {
        const auto boxes = samples::make_scene(kind, scaled(2'000'000, 10), 1);
        for (const int delay : {0, 5, 30, 80, 150}) {
            SCOPED_TRACE(std::string(kind) + " " + std::to_string(delay));
            expect_all_cancelled(boxes, GetParam(), milliseconds(delay), true);
        }
    }
}

TEST_P(Cancel, ListIsEmptyAfterwards) {
    const auto boxes = samples::make_scene("dense", scaled(2'000'000, 10), 1);
    const Objects objects{boxes};
    const auto engine = make_local_engine(GetParam());
    PairList list;
    for (const int delay : {0, 10, 40}) {
        std::uint64_t left = 0;
        expect_cancelled(
            [&](std::stop_token stop) {
                left = 0;
                try {
                    engine->find_pairs(objects, list, {}, stop);
                } catch (const Error&) {
                    left = list.size();
                    throw;
                }
            },
            milliseconds(delay), true);
        EXPECT_EQ(left, 0u);
    }
}

TEST(CancelBefore, ARequestMadeBeforeTheCallHolds) {
    const auto boxes = samples::make_scene("uniform", 1000, 1);
    PairList list;
    (void)error_of(ErrorCode::cancelled,
                   [&] { make_local_engine(2)->find_pairs({boxes}, list, {}, requested_stop()); });
}

}  // namespace
}  // namespace octopair::test
