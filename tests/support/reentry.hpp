// Checks callbacks that call the engine that runs them: they get an Error at once, and never wait.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <span>
#include <string>
#include <vector>

#include "octopair/engine.hpp"
#include "octopair/error.hpp"
#include "support/errors.hpp"

namespace octopair::test {

/// Returns boxes of which each overlaps the next one.
inline std::vector<Box3f> boxes_in_a_row(std::size_t count) {
    std::vector<Box3f> boxes;
    for (std::size_t i = 0; i < count; ++i) boxes.push_back({{float(i), 0, 0}, {float(i) + 1, 1, 1}});
    return boxes;
}

/// Calls `call`, and expects that it throws Error{usage} about a deadlock.
template <typename Call>
void expect_deadlock_refused(const Call& call) {
    expect_error(ErrorCode::usage, "deadlock", [&] { call(); });
}

/// Tries all calls of an engine that wait, in a callback of this engine.
inline void expect_calls_refused(Engine& engine) {
    const std::vector<Box3f> boxes = boxes_in_a_row(3);
    PairList pairs;
    expect_deadlock_refused([&] { (void)engine.find_pairs({boxes}, pairs); });
    expect_deadlock_refused([&] { (void)engine.count_pairs({boxes}); });
    expect_deadlock_refused([&] { (void)engine.stream_pairs({boxes}, [](std::span<const Pair>) {}); });
}

/// Checks all callbacks of calls and jobs. `jobs`: whether the engine has jobs.
inline void expect_reentry_is_refused(Engine& engine, bool jobs = true) {
    const std::vector<Box3f> boxes = boxes_in_a_row(20'000);
    const std::vector<Box3f> few = boxes_in_a_row(3);
    const auto other = make_local_engine(1);
    std::atomic<int> sinks = 0, reports = 0;
    const auto try_all = [&] {
        expect_calls_refused(engine);
        EXPECT_EQ(other->count_pairs({few}), 2u);
    };
    const PairSink sink = [&](std::span<const Pair>) {
        if (sinks++ > 0) return;
        try_all();
        if (!jobs) return;
        Job job = engine.submit(few);
        expect_deadlock_refused([&] { job.wait(); });
        expect_deadlock_refused([&] { (void)job.summary(); });
        EXPECT_FALSE(job.wait_for(std::chrono::milliseconds(1)));
    };
    Options options;
    options.progress = [&](double) {
        if (reports++ == 0) try_all();
    };
    (void)engine.stream_pairs({boxes}, sink, options);
    EXPECT_GT(sinks, 0);
    EXPECT_GT(reports, 0);
    if (jobs) {
        sinks = reports = 0;
        engine.submit_stream(boxes, sink, options).wait();
        EXPECT_GT(sinks, 0);
        EXPECT_GT(reports, 0);
    }
    EXPECT_EQ(engine.count_pairs({few}), 2u);  // the engine is usable
}

}  // namespace octopair::test
