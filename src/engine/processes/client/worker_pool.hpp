// WorkerPool: the workers of an engine, the control block that they share with the client, and what happens to them.
//
// A worker that dies or is stopped during a pass is replaced at once, and the one that takes over its slot does its share
// again. A share that has ended three workers ends its job.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/processes/client/worker_process.hpp"
#include "engine/processes/shared_memory/control_block.hpp"
#include "octopair/processes.hpp"

namespace octopair {

/// A piece of memory that workers are sent when they need it.
struct Region {
    explicit Region(SharedMemory held) : memory(std::move(held)) {}

    SharedMemory memory;
    std::uint32_t number = 0;  ///< given by the pool
};

/// What the client does while a pass is under way, on the calling thread.
struct PassWatch {
    std::stop_token stop;
    /// Called whenever there may be something to see, and at least every 20 ms.
    std::function<void()> look = {};
    /// A worker has ended, and its slot is about to be taken over.
    std::function<void(unsigned)> lost = {};
};

class WorkerPool {
public:
    WorkerPool(std::string program, unsigned workers);
    ~WorkerPool();
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    unsigned workers() const { return unsigned(pool_.size()); }
    ControlBlockView& view() { return view_; }
    /// From now on workers may be sent it. It is forgotten with its last owner.
    std::shared_ptr<Region> add_region(SharedMemory memory);
    /// The same of one that another made; no harm if it is known.
    void introduce(const std::shared_ptr<Region>& region);

    /// Has the first `pass.workers` workers do a pass, with `regions` at hand, and returns its number when all have ended
    /// it well. Throws Error: what went wrong in a worker, cancelled, or that workers keep ending; what `watch` throws; and
    /// OverBudget, LinearOctree::Invalid from a worker. Then too no worker is at work any more.
    std::uint32_t run(const Pass& pass, std::span<const std::shared_ptr<Region>> regions, const PassWatch& watch);
    /// How many shares the last pass had.
    std::uint64_t shares() const { return shares_; }
    std::uint32_t number() const { return number_; }

    /// The number of a new job.
    std::uint32_t begin_job() { return ++job_; }
    /// Thread-safe.
    WorkerFaults faults() const;

private:
    struct Member {
        std::unique_ptr<WorkerProcess> process;  ///< none where it could not be started
        unsigned failed_starts = 0;              ///< one after another
        std::chrono::steady_clock::time_point started_at = {};
        unsigned deaths_between_shares = 0;  ///< workers that soon ended outside of any share, one after another
    };
    void start(unsigned slot);
    [[noreturn]] void throw_cannot_start(const std::string& how) const;
    void restart_workers();
    void announce(const Pass& pass);
    void look(const PassWatch& watch, bool over, bool check);
    bool finished(unsigned slot) const;
    bool all_finished() const;
    void check_members(const PassWatch& watch);
    void handle_lost_worker(unsigned slot, bool stopped, const PassWatch& watch);
    void count_fault(std::uint64_t& fault);
    void count_death(unsigned slot);
    void check_crash_loop(unsigned slot);
    void check_deadlock();
    bool all_wait() const;
    std::uint64_t events() const;
    void fail(std::exception_ptr failure);
    void fail_as_worker(unsigned slot);
    void kill_unresponsive_workers();
    void send_regions(unsigned slot);
    void forget_regions();

    std::string program_;
    const pid_t owner_ = ::getpid();
    SharedMemory control_memory_;
    ControlBlockView view_;
    std::vector<Member> pool_;
    std::vector<std::weak_ptr<Region>> regions_;
    std::uint32_t next_region_ = control_region + 1;
    /// Of the pass. Not small, as what a broken worker writes where it should not often is.
    std::uint32_t number_ = 0x50000000;
    std::uint32_t job_ = 0;
    std::uint64_t shares_ = 0;
    Pass last_pass_;
    mutable std::mutex faults_mutex_;
    WorkerFaults faults_;

    // Of the pass under way.
    std::span<const std::shared_ptr<Region>> needed_;
    unsigned taking_part_ = 0;
    unsigned looks_ = 0;
    std::exception_ptr failure_;
    std::chrono::steady_clock::time_point failed_at_;
    std::uint64_t last_events_ = 0;  // as of the last change, at
    std::chrono::steady_clock::time_point changed_at_;
    std::map<std::uint64_t, unsigned> deaths_by_share_;  // workers that each share ended, in all attempts at the pass
};

}  // namespace octopair
