// JobTask: the state that a job's handle and the queue share: input, job state and result.
//
// Invariants
//   At most one thread ever *holds* a task: the queue's thread, which runs it, or a thread that cancels it while queued.
//   Only the holder accesses the input, the sink and the progress callback.
//   The holder frees them, and then sets the terminal state exactly once.
//   Other threads access only atomic members and members guarded by `mutex_`.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "octopair/engine.hpp"
#include "octopair/error.hpp"

namespace octopair::detail {

/// Returns a view of a job's input for the direct call. Borrows the argument.
Input view(const JobInput& input);

class JobTask {
public:
    struct Work {
        JobInput input;
        std::optional<PairSink> sink;  ///< absent: the pairs are collected in a PairList
        Options options;
    };

    explicit JobTask(Work work);
    JobTask(const JobTask&) = delete;
    JobTask& operator=(const JobTask&) = delete;
    ~JobTask() = default;

    /// Stores the id of the queue's thread. Requires: called before that thread receives the task.
    void belong_to(const Engine& engine, std::thread::id thread);
    /// Runs the task on the calling thread. Returns false if the task had already ended.
    /// Requires: called on the queue's thread.
    bool run(Engine& engine) noexcept;

    // The functions of Job (octopair/job.hpp).
    JobState state() const;
    bool ended() const;
    double progress() const { return progress_.load(std::memory_order_relaxed); }
    void cancel() noexcept;
    void wait() const;
    bool wait_at_most(std::chrono::nanoseconds time) const;
    /// Waits until the task has ended. Returns at once on the thread that holds the task.
    void wait_unless_holder() const;
    Summary summary() const;
    PairList take_pairs();

private:
    struct Ending {
        JobState state;
        Summary summary = {};
        std::optional<Error> error = {};       // absent if the job did not fail, or if it failed because memory ran out
        std::optional<ErrorPlace> place = {};  // place of the error in the input
    };

    bool hold(JobState state);
    Summary call(Engine& engine);
    void report_progress(double done);
    static Ending failure() noexcept;
    void end(Ending ending) noexcept;
    void check_can_end() const;
    void throw_unless_done() const;
    bool is_last() const { return state_ != JobState::queued && state_ != JobState::running; }

    std::optional<Work> work_;      // empty after the end; accessed only by the holder
    ProgressSink caller_progress_;  // accessed only by the holder
    std::optional<PairList> pairs_;
    std::stop_source stop_;
    std::atomic<double> progress_ = 0;

    mutable std::mutex mutex_;
    mutable std::condition_variable ended_;
    JobState state_ = JobState::queued;
    Ending ending_{};
    const Engine* engine_ = nullptr;  // engine whose queue has the task; compared only, never dereferenced
    std::thread::id queue_thread_;
    std::thread::id holder_;
};

}  // namespace octopair::detail
