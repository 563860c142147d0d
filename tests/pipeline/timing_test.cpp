// Tests how soon calls with filters end after a stop request.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "octopair/octopair.hpp"
#include "pipeline/flow.hpp"
#include "support/errors.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds patience(sanitized ? 3000 : 200);

/// Returns the time from a stop request to the end of a call.
Clock::duration time_to_cancel(const std::function<void(std::stop_token)>& call) {
    std::stop_source source;
    Clock::time_point asked;
    std::jthread stopper([&] {
        std::this_thread::sleep_for(milliseconds(100));
        asked = Clock::now();
        source.request_stop();
    });
    (void)error_of(ErrorCode::cancelled, [&] { call(source.get_token()); });
    const auto ended = Clock::now();
    stopper.join();
    return ended - asked;
}

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
            Clock::duration took{};
            for (int attempt = 0; attempt < 3; ++attempt) {  // a machine busy with other work delays any thread
                took = time_to_cancel(
                    [&](std::stop_token stop) { pipeline.run(*engine, all_of(boxes), {}, options, stop); });
                if (took <= patience) break;
            }
            EXPECT_LE(took, patience) << std::chrono::duration<double>(took).count() << " s";
        }
    }
}

}  // namespace
}  // namespace octopair::test
