// Errands: work that waits for disks, done one after another on a thread of its own, so that no thread of gRPC waits.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace octopair::service {

class Errands {
public:
    /// Throws nothing.
    using Errand = std::function<void()>;

    Errands() : thread_([this] { run(); }) {}
    Errands(const Errands&) = delete;
    Errands& operator=(const Errands&) = delete;
    /// Does what was added.
    ~Errands();

    /// Thread-safe.
    void add(Errand errand);

private:
    void run();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Errand> errands_;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace octopair::service
