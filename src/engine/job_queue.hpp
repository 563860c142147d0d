// JobQueue: the jobs of an engine, run one after another in the order in which they came, on one thread.
//
// The thread is started by the first job. An engine owns its queue as its last member: the queue's end cancels all jobs
// and joins the thread while the engine still has all that a job uses. A job that is cancelled while it waits ends
// there and then, and only its empty JobTask stays in the queue until its turn, or until such have become half of it. Where
// other processes take part in each job, such a one has its turn all the same, and is told to the engine.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "octopair/engine.hpp"

namespace octopair::detail {

class JobQueue {
public:
    /// `skipped`, if given, is called on the thread for each job whose turn comes after its end, the queue's end included.
    explicit JobQueue(Engine& engine, std::function<void()> skipped = {})
        : engine_(engine), skipped_(std::move(skipped)) {}
    JobQueue(const JobQueue&) = delete;
    JobQueue& operator=(const JobQueue&) = delete;
    /// From no thread of the queue.
    ~JobQueue();

    /// Throws Error{resource_limit} where no thread can be started. Thread-safe.
    void add(const std::shared_ptr<JobTask>& task);
    /// Returns when all jobs that were added have had their turn; at once on the thread of the queue. Thread-safe.
    void wait_for_all();

private:
    void start_thread();
    void run_jobs();
    std::shared_ptr<JobTask> next();
    void drop_ended();

    Engine& engine_;
    std::function<void()> skipped_;
    std::mutex mutex_;
    std::condition_variable changed_, idle_;
    std::deque<std::shared_ptr<JobTask>> waiting_;
    std::shared_ptr<JobTask> running_;
    std::size_t drop_from_ = 64;  // waiting jobs
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace octopair::detail
