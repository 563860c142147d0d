// CallThreads: threads of calls that need one of their own.
#pragma once

#include <atomic>
#include <functional>
#include <list>
#include <mutex>
#include <thread>

namespace octopair::service {

/// Thread-safe. Its end waits for all.
class CallThreads {
public:
    CallThreads() = default;
    CallThreads(const CallThreads&) = delete;
    CallThreads& operator=(const CallThreads&) = delete;

    /// Runs `work`, which throws nothing, on a new thread. Throws std::system_error if the system has none.
    void start(std::function<void()> work);

private:
    struct Running {
        std::atomic<bool> ended = false;
        std::jthread thread;
    };

    std::mutex mutex_;
    std::list<Running> running_;
};

}  // namespace octopair::service
