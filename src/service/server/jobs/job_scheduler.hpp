// JobScheduler: the engines of a server and the threads that drive them.
//
// Small jobs have engine_widths of their own, an engine of one thread each, so that they do not wait for large ones, which have
// one lane with all threads. Within a lane's queue jobs run in the order in which they came. Jobs so small that waking a
// thread would cost as much as they do run where they came in, as long as an engine for these is free; but no detached ones,
// which wait for memory and disks.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::service {

class ServerJob;

/// Makes an engine of so many threads or workers.
using EngineMaker = std::function<std::unique_ptr<Engine>(unsigned width)>;

/// Of jobs with so many objects one thread is as good as several, and starts at once.
inline constexpr std::uint64_t most_small_objects = 20000;

inline constexpr std::uint64_t most_instant_objects = 2000;

class JobScheduler {
public:
    struct Widths {
        unsigned large = 1;    ///< threads or workers of the large lane, at least 1
        unsigned small = 1;    ///< engine_widths, at least 1
        unsigned instant = 0;  ///< engines for jobs that run where they came in
    };
    /// Of the engine for large jobs, and of those for small ones.
    struct Makers {
        const EngineMaker &large, &small;
    };
    JobScheduler(const Makers& makers, const Widths& widths);
    JobScheduler(const JobScheduler&) = delete;
    JobScheduler& operator=(const JobScheduler&) = delete;
    /// Waits for the jobs that run; those that wait do not run any more.
    ~JobScheduler();

    /// The engine that will run a job of so many objects, or one like it: for its input. Thread-safe.
    Engine& engine_for(std::uint64_t objects);
    /// Of a job in state queued, which may have ended on return. Thread-safe.
    void add(std::shared_ptr<ServerJob> job);
    /// Detached jobs that wait do so from here on, for the next server. Thread-safe.
    void hold_detached();
    /// Of others that wait before it; none, if it does not wait.
    std::uint64_t queued_before(const ServerJob& job) const;
    std::uint64_t waiting() const;
    /// Added up over all engines.
    std::uint64_t sum(const std::function<std::uint64_t(const Engine&)>& value) const;

private:
    struct Queue {
        mutable std::mutex mutex;
        std::condition_variable changed;
        std::deque<std::shared_ptr<ServerJob>> jobs;
        std::size_t drop_from = 64;
        bool holds_detached = false;
        bool ending = false;
    };

    struct Instant {
        std::mutex mutex;
        std::unique_ptr<Engine> engine;
    };

    bool run_at_once(ServerJob& job);
    Queue& queue_of(std::uint64_t objects) { return objects <= most_small_objects ? small_ : large_; }
    void stop();
    void start(Queue& queue, const EngineMaker& maker, unsigned width);
    static void drive(Queue& queue, Engine& engine);
    static std::shared_ptr<ServerJob> next(Queue& queue);

    Queue small_, large_;
    std::vector<std::unique_ptr<Engine>> engines_;  // the large lane's first
    std::vector<Instant> instant_;
    std::vector<std::jthread> threads_;
};

}  // namespace octopair::service
