// Throttle: lets one line of the log a second pass for each key, and counts the lines between.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace octopair::service {

/// Thread safety: any thread may call it.
class Throttle {
public:
    using Clock = std::chrono::steady_clock;

    /// Returns the number of lines of this key that were left out since its last line, or nothing if this line is left out as well.
    std::optional<std::uint64_t> pass(const std::string& key, Clock::time_point now = Clock::now()) {
        constexpr std::chrono::seconds apart(1);
        constexpr std::size_t most = 1000;
        const std::lock_guard lock(mutex_);
        if (keys_.size() >= most)
            std::erase_if(keys_, [&](const auto& known) { return now - known.second.last >= apart; });
        if (keys_.size() >= most && !keys_.contains(key)) return {};
        Key& known = keys_[key];
        if (known.last != Clock::time_point() && now - known.last < apart) {
            ++known.left_out;
            return {};
        }
        known.last = now;
        return std::exchange(known.left_out, 0);
    }

private:
    struct Key {
        Clock::time_point last{};
        std::uint64_t left_out = 0;
    };

    std::mutex mutex_;
    std::map<std::string, Key> keys_;
};

}  // namespace octopair::service
