// Tests Team: the limit of threads; every index runs once, workers have separate numbers, exceptions propagate, helpers take part.
#include "parallel/team.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/errors.hpp"
#include "support/peak_memory.hpp"

namespace octopair::test {
namespace {

class TeamOf : public ::testing::TestWithParam<unsigned> {
protected:
    Team team_{GetParam()};
};

TEST_P(TeamOf, CallsTheBodyOnceForEachIndex) {
    for (const std::size_t count : {0u, 1u, 2u, 1'000u}) {
        std::vector<std::atomic<int>> times(count);
        team_.for_each(count, [&](std::size_t i, unsigned) { ++times[i]; });
        for (const auto& calls : times) EXPECT_EQ(calls, 1);
    }
}

TEST_P(TeamOf, NoTwoRunningBodiesShareAWorker) {
    std::vector<std::atomic<int>> running(team_.threads());
    std::atomic<int> shared = 0;
    team_.for_each(500, [&](std::size_t, unsigned worker) {
        if (++running[worker] != 1) ++shared;
        std::this_thread::yield();
        --running[worker];
    });
    EXPECT_EQ(shared, 0);
}

TEST_P(TeamOf, RethrowsTheFailureOfABodyAndStartsNoOther) {
    // Bodies after index 3 wait until index 3 throws. Then each body takes 100 microseconds, so all 100,000 bodies take
    // at least 2 seconds. This is longer than the system may delay the thread that throws.
    std::atomic<int> begun = 0;
    std::atomic<bool> failing = false;
    const auto body = [&](std::size_t i, unsigned) {
        ++begun;
        if (i == 3) {
            failing = true;
            throw std::runtime_error("index 3");
        }
        while (i > 3 && !failing) std::this_thread::yield();
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    };
    EXPECT_THROW(team_.for_each(100'000, body), std::runtime_error);
    EXPECT_LT(begun, 100'000);
    team_.for_each(10, [&](std::size_t, unsigned) {});  // the team can be used again
}

TEST_P(TeamOf, LeadsOnTheCallingThread) {
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> led = false, over = false;
    std::atomic<unsigned> helpers = 0;
    team_.with_helpers(
        [&] {
            EXPECT_EQ(std::this_thread::get_id(), caller);
            led = true;
            over = true;
        },
        [&] {
            ++helpers;
            while (!over) std::this_thread::yield();
        });
    EXPECT_TRUE(led);
    EXPECT_LT(helpers, team_.threads());
}

INSTANTIATE_TEST_SUITE_P(Threads, TeamOf, ::testing::Values(1u, 2u, 5u));

/// oneTBB keeps memory of each arena that threads entered, so teams must use arenas again.
TEST(Team, ManyTeamsOneAfterAnotherTakeNoMemory) {
    const auto work = [] {
        Team team(2);
        std::atomic<int> calls = 0;
        const std::function<void(std::size_t, unsigned)> body = [&](std::size_t, unsigned) { ++calls; };
        team.for_each(64, body);
        EXPECT_EQ(calls, 64);
    };
    for (int i = 0; i < 300; ++i) work();
    const std::uint64_t before = peak_rss();
    for (int i = 0; i < 2000; ++i) work();
#ifndef OCTOPAIR_TEST_SANITIZED
    EXPECT_LT(peak_rss() - before, 4u << 20);  // new arenas would take 14 MB
#else
    static_cast<void>(before);
#endif
}

TEST(Team, HasAThreadForEachCoreByDefault) { EXPECT_GE(Team(0).threads(), 1u); }

TEST(ThreadLimit, IsOneForAllUsers) {
    const std::string message = "threads: 4097 is not in the range 0 to 4096";
    EXPECT_EQ(error_of(ErrorCode::usage, [] { (void)make_local_engine(max_threads + 1); }), message);
    EXPECT_EQ(error_of(ErrorCode::usage, [] { Scene scene({.threads = max_threads + 1}); }), message);
    EXPECT_EQ(error_of(ErrorCode::usage, [] { Team team(max_threads + 1); }), message);
    EXPECT_EQ(thread_count(max_threads), max_threads);
    EXPECT_GE(thread_count(0), 1u);
}

}  // namespace
}  // namespace octopair::test
