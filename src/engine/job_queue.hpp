// JobQueue: the jobs of an engine, run one after another, in the order in which they were added, on one thread.
//
// Invariants
//   The first job starts the thread. The engine owns its queue as its last member, so the queue ends first: it cancels all
//   jobs and joins the thread while all that a job uses still exists.
//   A job that is cancelled while it waits ends at once. Its empty JobTask stays in the queue until its turn. Without `skipped`, empty
//   tasks are also removed each time the length of the queue has doubled. With `skipped`, `skipped` is called at the task's turn.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "base/work_queue.hpp"
#include "octopair/engine.hpp"

namespace octopair::detail {

class JobQueue {
public:
    /// `skipped`, if given, is called on the queue's thread for each job that had ended before its turn; also at the queue's
    /// end. An engine with ranks needs it, because all ranks take part in each job.
    explicit JobQueue(Engine& engine, std::function<void()> skipped = {})
        : engine_(engine), skipped_(std::move(skipped)) {}
    JobQueue(const JobQueue&) = delete;
    JobQueue& operator=(const JobQueue&) = delete;
    /// Requires: the calling thread is not the queue's.
    ~JobQueue();

    /// Throws: Error{resource_limit} if no thread can be started.
    /// Thread safety: may be called from any thread.
    void add(const std::shared_ptr<JobTask>& task);
    /// Returns when all added jobs have had their turn; at once on the queue's thread.
    /// Thread safety: may be called from any thread.
    void wait_for_all();

private:
    void start_thread();
    void run_jobs();

    Engine& engine_;
    std::function<void()> skipped_;
    WorkQueue<std::shared_ptr<JobTask>> tasks_;
    std::mutex mutex_;  // guards thread_
    std::thread thread_;
};

}  // namespace octopair::detail
