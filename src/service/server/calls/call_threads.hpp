// CallThreads: starts a thread for each call that needs its own.
#pragma once

#include <atomic>
#include <functional>
#include <list>
#include <mutex>
#include <thread>

namespace octopair::service {

/// The destructor waits for all threads. Thread safety: any thread may call it.
class CallThreads {
public:
    CallThreads() = default;
    CallThreads(const CallThreads&) = delete;
    CallThreads& operator=(const CallThreads&) = delete;

    /// Runs `work` on a new thread. Requires: `work` does not throw. Throws: std::system_error if no thread can be created.
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
