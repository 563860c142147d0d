// Tests how soon calls with filters end after a stop request.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "octopair/octopair.hpp"
#include "pipeline/flow.hpp"
#include "support/cancel_time.hpp"
#include "support/errors.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Returns a filter that takes a given time for every pair: it spins for short times and sleeps for long times.
std::unique_ptr<Filter> slow_filter(Clock::duration of_a_pair) {
    return make_filter("slow", [of_a_pair](Pair) {
        const auto end = Clock::now() + of_a_pair;
        if (of_a_pair >= milliseconds(1)) std::this_thread::sleep_until(end);
        while (Clock::now() < end) {
        }
        return true;
    });
}

class PipelineTiming : public ::testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Threads, PipelineTiming, ::testing::Values(1u, 2u, 7u));

TEST_P(PipelineTiming, StopsInTime) {
    const std::vector<Box3f> boxes = samples::make_scene("dense", 20'000, 1);
    const auto engine = make_local_engine(2);
    for (const Order order : {Order::octal, Order::ascending}) {
        Options options{.order = order, .buffer_bytes = 1 << 20};
        for (const Clock::duration of_a_pair :
             {Clock::duration(std::chrono::microseconds(20)), Clock::duration(milliseconds(10))}) {
            Pipeline pipeline(GetParam());
            pipeline.add(slow_filter(of_a_pair));
            expect_cancelled([&](std::stop_token stop) { pipeline.run(*engine, all_of(boxes), {}, options, stop); },
                             milliseconds(100), false);
        }
    }
}

}  // namespace
}  // namespace octopair::test
