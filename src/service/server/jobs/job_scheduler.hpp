// JobScheduler: the engines of a server, the threads that drive them, and the jobs that wait for them.
//
// Invariants
//   Jobs of at most `max_small_objects` objects have engines of one thread each, so they never wait for large jobs. Large
//   jobs share one engine with all threads.
//   In each of the two queues (small and large jobs), clients take turns (fair_order.hpp). The jobs of one client run in the order of
//   add(). While a detached job waits for memory, attached jobs may run before this job, but later detached jobs may not.
//   If the server distinguishes clients, and has several engines of small jobs, one client uses at most all but one of them: a job with a
//   small number of objects can have so many pairs that it takes long.
//   An engine keeps the memory of its largest job. So a renewable engine that was idle for `idle_before_renewal` is made anew.
//   An attached job of at most `max_instant_objects` objects runs on the calling thread if an instant engine is free.
//   Waking a thread would take as long as the job.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/work_queue.hpp"
#include "octopair/engine.hpp"
#include "service/server/jobs/fair_order.hpp"

namespace octopair::service {

/// Makes an engine with `width` threads or workers.
using EngineMaker = std::function<std::unique_ptr<Engine>(unsigned width)>;

/// An engine of the server. It can be made anew while no job uses it, which gives back the memory that it keeps for later jobs. Thread
/// safety: any thread may call it.
class KeptEngine {
public:
    KeptEngine(const EngineMaker& maker, unsigned width) : maker_(maker), width_(width), engine_(maker_(width_)) {}

    /// Returns the engine. It is in use while a copy of the pointer exists.
    std::shared_ptr<Engine> use() {
        const std::lock_guard lock(mutex_);
        was_used_ = true;
        return engine_;
    }

    /// Makes the engine anew if it was used, and is not in use now. Throws: what the maker throws; the engine stays then.
    void renew() {
        std::shared_ptr<Engine> old;  // destroyed after the lock is released
        const std::lock_guard lock(mutex_);
        if (!was_used_ || engine_.use_count() > 1) return;
        old = maker_(width_);
        old.swap(engine_);
        was_used_ = false;
    }

private:
    const EngineMaker maker_;
    const unsigned width_;
    std::mutex mutex_;
    std::shared_ptr<Engine> engine_;
    bool was_used_ = false;  // true if use() was called since the engine was made
};

class ServerJob;

/// Maximum number of objects of a small job. Up to this size one thread searches as fast as several, and starts sooner.
inline constexpr std::uint64_t max_small_objects = 20000;
inline constexpr std::uint64_t max_instant_objects = 2000;

inline constexpr std::chrono::seconds idle_before_renewal(3);

/// Thread safety: all functions but the destructor may be called from any thread.
class JobScheduler {
public:
    struct Widths {
        unsigned large = 1;    ///< threads or workers of the engine for large jobs, at least 1
        unsigned small = 1;    ///< number of engines for small jobs, at least 1
        unsigned instant = 0;  ///< number of engines for jobs that run on the calling thread
    };
    struct Makers {
        const EngineMaker &large, &small;  ///< make the engine for large jobs, and those for small and instant ones
        bool tells_clients_apart = false;  ///< true: one client may not use all engines of small jobs
        bool renewable = false;            ///< true: making an engine is cheap (no worker processes, no ranks)
        /// Called on the thread of large jobs after `idle_before_renewal` without a large job, if any job has ended since the last call.
        /// May be empty.
        std::function<void()> on_idle = {};
    };
    JobScheduler(const Makers& makers, const Widths& widths);
    JobScheduler(const JobScheduler&) = delete;
    JobScheduler& operator=(const JobScheduler&) = delete;
    /// Waits for the running jobs. Jobs in the queues never run.
    ~JobScheduler();

    /// Returns an engine that allocates the input of a job with `objects` objects.
    std::shared_ptr<Engine> engine_for(std::uint64_t objects);
    /// Requires: `job` is in state queued. It may have ended on return.
    void add(std::shared_ptr<ServerJob> job);
    /// Prevents detached jobs from starting. The next server on this state folder runs the waiting detached jobs.
    void hold_detached() { holds_detached_ = true; }

    /// Returns the number of waiting jobs that were added before `job`; 0 if `job` does not wait. The order of running may differ, because
    /// clients take turns.
    std::uint64_t queued_before(const ServerJob& job) const;
    std::uint64_t waiting() const { return small_.queue.waiting() + large_.queue.waiting(); }
    /// Returns the sum of value(engine) over all engines but the instant ones.
    std::uint64_t sum(const std::function<std::uint64_t(const Engine&)>& value) const;

private:
    using Queue = WorkQueue<std::shared_ptr<ServerJob>>;
    /// A queue of jobs, and the order in which clients take turns.
    struct Lane {
        Queue queue;
        unsigned engines = 0;
        std::mutex mutex;  // guards the members below; locked after the queue
        FairOrder order;
        std::map<std::string, unsigned> running;  // number of running jobs of each client
    };
    struct Instant {
        std::mutex mutex;
        std::unique_ptr<KeptEngine> engine;
    };
    bool run_at_once(ServerJob& job);
    Lane& lane_of(std::uint64_t objects) { return objects <= max_small_objects ? small_ : large_; }
    void stop();
    void start(Lane& lane, const EngineMaker& maker, unsigned width);
    void run_next(Lane& lane, KeptEngine& engine, const std::shared_ptr<ServerJob>& job);
    void renew_idle(Lane& lane, KeptEngine& engine);
    Queue::Items::iterator next_ready(Queue::Items& jobs, Lane& lane) const;

    const bool tells_clients_apart_, renewable_;
    const std::function<void()> on_idle_;
    Lane small_, large_;
    std::atomic<bool> holds_detached_ = false;
    std::atomic<std::uint64_t> ended_ = 0;  // number of jobs that have run
    std::uint64_t cleaned_after_ = 0;       // value of ended_ at the last on_idle_(); only for the thread of large jobs
    std::vector<std::unique_ptr<KeptEngine>> engines_;  // the engine for large jobs, then the engines for small jobs
    std::vector<Instant> instant_;
    std::vector<std::jthread> threads_;
};

}  // namespace octopair::service
