// Watchdog: a thread that checks the deadlines of jobs and calls ten times a second, by the monotonic clock.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace octopair::service {

class LimitError;

class Watched {
public:
    virtual ~Watched() = default;
    /// Ends the object's work if it has taken too long. Called on the watchdog's thread. Requires: does not block.
    virtual void check_deadline(std::chrono::steady_clock::time_point now) = 0;
    /// Returns whether the watchdog may drop this object.
    virtual bool is_over() const { return false; }
};

/// Thread safety: any thread may call it.
class Watchdog {
public:
    Watchdog();
    Watchdog(const Watchdog&) = delete;
    Watchdog& operator=(const Watchdog&) = delete;
    ~Watchdog();

    /// Checks `watched` until it is destroyed or is_over().
    void watch(const std::shared_ptr<Watched>& watched);

    /// Returns the number of rounds of checks so far.
    std::uint64_t beats() const { return beats_; }

private:
    void poll_watched();

    std::atomic<std::uint64_t> beats_ = 0;

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::weak_ptr<Watched>> watched_;
    bool ending_ = false;
    std::thread thread_;
};

/// Returns the error for exceeding `job_seconds`. `what`: subject of the message, as in "the job".
LimitError ran_too_long(const std::string& what, double max_seconds);

}  // namespace octopair::service
