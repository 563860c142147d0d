// DiskQueue: work that waits for disks, done one after another on a thread of its own, so that no thread of gRPC waits.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace octopair::service {

class DiskQueue {
public:
    /// Throws nothing.
    using Errand = std::function<void()>;

    DiskQueue() : thread_([this] { run(); }) {}
    DiskQueue(const DiskQueue&) = delete;
    DiskQueue& operator=(const DiskQueue&) = delete;
    /// Does what was added.
    ~DiskQueue();

    /// Thread-safe.
    void add(Errand errand);

private:
    void run();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Errand> disk_queue_;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace octopair::service
