// Watchdog: looks at all that must not take for ever, ten times a second, by a clock that nobody can set.
#pragma once

#include <chrono>
#include <condition_variable>
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
    /// From the watchdog's thread; must not block.
    virtual void look(std::chrono::steady_clock::time_point now) = 0;
    /// It need not be looked at any more.
    virtual bool is_over() const { return false; }
};

/// Thread-safe.
class Watchdog {
public:
    Watchdog();
    Watchdog(const Watchdog&) = delete;
    Watchdog& operator=(const Watchdog&) = delete;
    ~Watchdog();

    /// As long as it lives.
    void watch(const std::shared_ptr<Watched>& watched);

private:
    void look_around();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::weak_ptr<Watched>> watched_;
    bool ending_ = false;
    std::thread thread_;
};

/// The limit that `what` ("the job") ran into.
LimitError ran_too_long(const std::string& what, double most_seconds);

}  // namespace octopair::service
