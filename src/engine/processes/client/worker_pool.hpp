// WorkerPool: starts, supervises and replaces the worker processes of an engine. Owns the control block.
//
// Invariants
//   A worker that dies or is stopped during a pass is replaced in its slot. The replacement worker runs the unfinished share
//   again.
//   A share in which three workers died fails the pass (worker_timeouts.hpp).
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

/// Shared memory with a number. A worker receives it before the first pass that needs it.
struct Region {
    explicit Region(SharedMemory held) : memory(std::move(held)) {}

    SharedMemory memory;
    std::uint32_t number = 0;  ///< assigned by the pool; 0: none yet
};

/// Callbacks of the client during a pass. They run on the calling thread.
struct PassWatch {
    std::stop_token stop;
    /// Called after each event of the workers, and at least every 20 ms.
    std::function<void()> poll = {};
    /// Called with the slot of a worker that has ended, before its replacement starts.
    std::function<void(unsigned)> on_worker_lost = {};
};

class WorkerPool {
public:
    WorkerPool(std::string program, unsigned workers);
    ~WorkerPool();
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    unsigned workers() const { return unsigned(pool_.size()); }
    ControlBlockView& view() { return view_; }
    /// Returns a registered region that owns `memory`. Workers drop the region after its last owner has released it.
    std::shared_ptr<Region> add_region(SharedMemory memory);
    /// Assigns a number to a region that was created elsewhere. Does nothing if the region already has a number.
    void register_region(const std::shared_ptr<Region>& region);

    /// Runs a pass on the first `pass.workers` workers, which get `regions`. Returns the number of the pass after all workers
    /// have finished it. No worker is in the pass any more when run() returns or throws.
    /// Throws: the Error of a worker; Error{cancelled}; Error{engine_failed} if workers keep dying; OverBudget or
    /// LinearOctree::Invalid of a worker; what `watch` throws.
    std::uint32_t run(const Pass& pass, std::span<const std::shared_ptr<Region>> regions, const PassWatch& watch);
    /// Number of shares of the last successful pass.
    std::uint64_t shares() const { return shares_; }
    /// Number of the last pass.
    std::uint32_t number() const { return number_; }

    /// Returns the number of a new job.
    std::uint32_t begin_job() { return ++job_; }
    /// Returns the number of faults so far. Thread safety: any thread.
    WorkerFaults faults() const;

private:
    struct Member {
        std::unique_ptr<WorkerProcess> process;  ///< null if the process could not be started
        unsigned failed_starts = 0;              ///< consecutive
        std::chrono::steady_clock::time_point started_at = {};
        unsigned deaths_between_shares = 0;  ///< consecutive early deaths outside any share
    };
    void start(unsigned slot);
    [[noreturn]] void throw_cannot_start(const ProcessEnd& end) const;
    void restart_workers();
    void publish_pass(const Pass& pass);
    void poll(const PassWatch& watch, bool over, bool check);
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
    /// Pass number. Starts high so that stray small integers in shared memory never match a pass.
    std::uint32_t number_ = 0x50000000;
    std::uint32_t job_ = 0;
    std::uint64_t shares_ = 0;
    Pass last_pass_;
    mutable std::mutex faults_mutex_;
    WorkerFaults faults_;

    // State of the current pass.
    std::span<const std::shared_ptr<Region>> needed_;
    unsigned active_workers_ = 0;
    unsigned max_spins_ = 0;  // polls before the client sleeps
    std::exception_ptr failure_;
    std::chrono::steady_clock::time_point failed_at_;
    std::uint64_t last_events_ = 0;                      // activity counter at the last change
    std::chrono::steady_clock::time_point changed_at_;   // time of the last change
    std::map<std::uint64_t, unsigned> deaths_by_share_;  // number of deaths in each share, over all attempts at a pass
};

}  // namespace octopair
