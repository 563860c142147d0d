#include "service/server/jobs/watchdog.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "service/protocol/errors.hpp"

namespace octopair::service {

Watchdog::Watchdog() : thread_([this] { poll_watched(); }) {}

Watchdog::~Watchdog() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        changed_.notify_all();
    }
    thread_.join();
}

void Watchdog::watch(const std::shared_ptr<Watched>& watched) {
    const std::lock_guard lock(mutex_);
    watched_.push_back(watched);
}

void Watchdog::poll_watched() {
    constexpr std::chrono::milliseconds poll_interval(100);
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, poll_interval, [&] { return ending_; })) {
        std::erase_if(watched_, [](const auto& known) {
            const auto one = known.lock();
            return !one || one->is_over();
        });
        const auto checked = watched_;
        lock.unlock();
        const auto now = std::chrono::steady_clock::now();
        for (const auto& weak : checked) {
            if (const auto one = weak.lock()) one->check_deadline(now);
        }
        ++beats_;
        lock.lock();
    }
}

LimitError ran_too_long(const std::string& what, double max_seconds) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), max_seconds).ptr;
    return {
        "job_seconds", std::uint64_t(std::ceil(max_seconds)),
        "job_seconds: " + what + " ran longer than " + std::string(text.data(), end) + " s, the limit of the server"};
}

}  // namespace octopair::service
