// JobQueue: the jobs of an engine, run one after another in the order in which they came, on one thread.
//
// The thread is started by the first job. An engine owns its queue as its last member: the queue's end cancels all jobs
// and joins the thread while the engine still has all that a job uses. A job that is cancelled while it waits ends
// there and then, and only its empty Task stays in the queue until its turn, or until such have become half of it.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

#include "octopair/engine.hpp"

namespace octopair {

class JobQueue {
public:
    explicit JobQueue(Engine& engine) : engine_(engine) {}
    JobQueue(const JobQueue&) = delete;
    JobQueue& operator=(const JobQueue&) = delete;
    /// From no thread of the queue.
    ~JobQueue();

    /// Throws Error{resource_limit} where no thread can be started. Thread-safe.
    void add(const std::shared_ptr<Job::Task>& task);

private:
    void start_thread();
    void run_jobs();
    std::shared_ptr<Job::Task> next();
    void drop_ended();

    Engine& engine_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::shared_ptr<Job::Task>> waiting_;
    std::shared_ptr<Job::Task> running_;
    std::size_t drop_from_ = 64;  // waiting jobs
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace octopair
