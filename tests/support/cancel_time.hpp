// How soon a call ends after a stop request.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <stop_token>
#include <thread>

#include "octopair/error.hpp"
#include "support/scale.hpp"

namespace octopair::test {

inline constexpr std::chrono::milliseconds cancel_patience(sanitized ? 3000 : 200);

/// Runs `call(stop_token)` and requests a stop after `delay`. Returns the time until Error{cancelled}, or nothing if
/// the call ended before the request.
template <typename Call>
std::optional<std::chrono::steady_clock::duration> time_to_cancel(const Call& call, std::chrono::milliseconds delay) {
    using Clock = std::chrono::steady_clock;
    std::stop_source source;
    Clock::time_point asked = Clock::time_point::max();
    std::jthread stopper([&] {
        std::this_thread::sleep_for(delay);
        asked = Clock::now();
        source.request_stop();
    });
    bool finished = false;
    try {
        call(source.get_token());
        finished = true;
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled) << error.what();
    }
    const Clock::time_point ended = Clock::now();
    stopper.join();
    if (finished) return std::nullopt;
    return ended - asked;
}

/// Expects Error{cancelled} in time, in at least one of a few attempts: a machine busy with other work delays any
/// thread. With `may_finish`, a call may also finish before the request.
template <typename Call>
void expect_cancelled(const Call& call, std::chrono::milliseconds delay, bool may_finish) {
    std::optional<std::chrono::steady_clock::duration> took;
    for (int attempt = 0; attempt < 3; ++attempt) {
        took = time_to_cancel(call, delay);
        if (!took || *took <= cancel_patience) break;
    }
    if (!took) {
        EXPECT_TRUE(may_finish) << "finished despite the stop request";
    } else {
        EXPECT_LE(*took, cancel_patience) << std::chrono::duration<double>(*took).count() << " s";
    }
}

}  // namespace octopair::test
