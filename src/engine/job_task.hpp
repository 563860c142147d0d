// JobTask: what the handle of a job and the queue share: its input, its state, its result.
//
// Exactly one thread *holds* a task: the queue's, to run it, or the one that cancelled it while it waited. The holder
// alone touches input, sink and progress, frees them, and then, once, gives the task its last state. All others see
// what the mutex guards.
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

/// Returns the input of the call that a job makes. Borrows the argument.
Input view(const JobInput& input);

class JobTask {
public:
    struct Work {
        JobInput input;
        std::optional<PairSink> sink;  ///< none: the pairs are collected
        Options options;
    };

    explicit JobTask(Work work);
    JobTask(const JobTask&) = delete;
    JobTask& operator=(const JobTask&) = delete;
    ~JobTask() = default;

    /// For the queue: its thread, before that gets the task; and the task's turn, on that thread.
    void belong_to(std::thread::id thread);
    /// False where it had ended before.
    bool run(Engine& engine) noexcept;

    /// For the handle; as Job's.
    JobState state() const;
    bool ended() const;
    double progress() const { return progress_.load(std::memory_order_relaxed); }
    void cancel() noexcept;
    void wait() const;
    bool wait_at_most(std::chrono::nanoseconds time) const;
    /// Waits, unless on the thread that holds the task.
    void wait_elsewhere() const;
    Summary summary() const;
    PairList take_pairs();

private:
    struct Ending {
        JobState state;
        Summary summary = {};
        std::optional<Error> error = {};  // none: there was no memory for one
    };

    bool hold(JobState state);
    Summary call(Engine& engine);
    void tell(double done);
    static Ending failure() noexcept;
    void end(Ending ending) noexcept;
    void throw_unless_done() const;
    bool is_last() const { return state_ != JobState::queued && state_ != JobState::running; }

    std::optional<Work> work_;  // until the end; the holder's
    ProgressSink told_;         // the caller's progress; the holder's as well
    std::optional<PairList> pairs_;
    std::stop_source stop_;
    std::atomic<double> progress_ = 0;

    mutable std::mutex mutex_;
    mutable std::condition_variable ended_;
    JobState state_ = JobState::queued;
    Ending ending_{};
    std::thread::id queue_thread_;
    std::thread::id holder_;
};

}  // namespace octopair::detail
