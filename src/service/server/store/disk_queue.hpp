// DiskQueue: tasks that wait for disks, run one after another on a thread of their own, so that no thread of gRPC waits.
#pragma once

#include <functional>
#include <thread>
#include <utility>

#include "base/work_queue.hpp"

namespace octopair::service {

class DiskQueue {
public:
    /// Must not throw.
    using DiskTask = std::function<void()>;

    DiskQueue() : thread_([this] { tasks_.run([](const DiskTask& task) { task(); }); }) {}
    DiskQueue(const DiskQueue&) = delete;
    DiskQueue& operator=(const DiskQueue&) = delete;
    /// Runs all tasks that were added.
    ~DiskQueue() {
        tasks_.finish();
        thread_.join();
    }

    /// Thread safety: may be called from any thread.
    void add(DiskTask task) { tasks_.add(std::move(task)); }

private:
    WorkQueue<DiskTask> tasks_;
    std::thread thread_;
};

}  // namespace octopair::service
