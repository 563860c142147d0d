// Backoff: pauses of a rank that waits for messages and must probe for them.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

namespace octopair {

/// Pauses the calling thread. A pause grows with the time since the backoff was made, up to 5 ms, a delay that a person does not notice.
/// In the first millisecond it only yields the processor.
class Backoff {
public:
    void operator()() const {
        constexpr std::chrono::milliseconds awake(1), longest(5);
        const auto waited = std::chrono::steady_clock::now() - begun_;
        if (waited <= awake) return std::this_thread::yield();
        std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(waited / 8, longest));
    }

private:
    std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace octopair
