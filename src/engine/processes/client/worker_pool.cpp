#include "engine/processes/client/worker_pool.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/control_group.hpp"
#include "engine/processes/worker_timeouts.hpp"
#include "octopair/error.hpp"
#include "octree/build/linear_octree.hpp"

namespace octopair {

namespace {

using Clock = std::chrono::steady_clock;

/// Pseudo share `preparing - slot`: the worker died before its first share.
constexpr std::uint64_t preparing = ~std::uint64_t(0);

SharedMemory make_control_memory(unsigned workers) {
    SharedMemory memory = SharedMemory::create(ControlBlockLayout::bytes(workers));
    ControlBlockView::lay_out(memory, workers);
    return memory;
}

/// Returns true if pass `b` repeats pass `a`, so that both divide their work into the same shares.
bool same_work(const Pass& a, const Pass& b) {
    return a.job == b.job && a.kind == b.kind && a.built == b.built && a.bounds.rows.begin == b.bounds.rows.begin;
}

}  // namespace

WorkerPool::WorkerPool(std::string program, unsigned workers)
    : program_(std::move(program)),
      control_memory_(make_control_memory(workers)),
      view_(control_memory_),
      pool_(workers) {
    for (unsigned slot = 0; slot < workers; ++slot) start(slot);
}

WorkerPool::~WorkerPool() = default;

std::shared_ptr<Region> WorkerPool::add_region(SharedMemory memory) {
    auto region = std::make_shared<Region>(std::move(memory));
    register_region(region);
    return region;
}

void WorkerPool::register_region(const std::shared_ptr<Region>& region) {
    if (region->number != 0) return;
    region->number = next_region_++;
    regions_.push_back(region);
}

WorkerFaults WorkerPool::faults() const {
    const std::lock_guard lock(faults_mutex_);
    return faults_;
}

void WorkerPool::count_fault(std::uint64_t& fault) {
    const std::lock_guard lock(faults_mutex_);
    ++fault;
}

/// Starts a worker for a slot and sends it the control block. Throws: Error after three failed starts.
void WorkerPool::start(unsigned slot) {
    Member& member = pool_[slot];
    ProcessEnd end;
    for (unsigned i = 0; i < worker_failures::max_failed_starts; ++i) {
        member.process = nullptr;
        view_.slot(slot).attached.store(0);
        view_.slot(slot).waits.store(0);
        view_.slot(slot).command.waiting.store(0);
        member.process = std::make_unique<WorkerProcess>(program_, slot);
        member.started_at = Clock::now();
        if (member.process->send_region(control_region, control_memory_)) return;
        end = member.process->end();
    }
    member.process = nullptr;
    throw_cannot_start(end);
}

void WorkerPool::throw_cannot_start(const ProcessEnd& end) const {
    if (end.lacked_resources)
        throw Error(ErrorCode::resource_limit, "worker processes get no memory, threads or descriptors: " + program_);
    throw Error(ErrorCode::engine_failed, "worker processes end at their start, " + end.how + ": " + program_);
}

/// Replaces workers that ended between passes or could not be started before.
void WorkerPool::restart_workers() {
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        Member& member = pool_[slot];
        if (member.process != nullptr && member.process->poll_state() == ProcessState::runs) continue;
        // Cancel the worker's unfinished pass: its result is no longer needed.
        view_.slot(slot).requested.store(view_.slot(slot).finished.load());
        if (member.process != nullptr) {
            count_fault(member.process->poll_state() == ProcessState::ended ? faults_.ended : faults_.stopped);
        }
        start(slot);
    }
}

/// Writes a new pass to the control block, resets the slots and wakes the workers.
void WorkerPool::publish_pass(const Pass& pass) {
    if (++number_ == 0) ++number_;
    ControlBlock& control_block = view_.control_block();
    control_block.pass = pass;
    control_block.next_block.store(0);
    control_block.next_run.store(0);
    control_block.pages_left.store(
        std::int64_t(std::min(pass.bounds.max_pairs / page_pairs(), std::uint64_t(1) << 62)));
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        Slot& part = view_.slot(slot);
        part.outcome = Outcome::none;
        part.share.store(0);
        part.preparing.store(1);
        part.entries_scanned.store(0);
        part.pairs_to_order.store(0);
        part.pairs_ordered.store(0);
        part.pages_taken.store(0);
        part.ring_filled.store(0);
        part.ring_taken.store(0);
        part.requested.store(number_);
        part.command.raise();
    }
}

std::uint32_t WorkerPool::run(const Pass& pass, std::span<const std::shared_ptr<Region>> regions,
                              const PassWatch& watch) {
    if (::getpid() != owner_)
        throw Error(ErrorCode::usage, "the engine belongs to the parent process: make a new engine after fork");
    if (!same_work(pass, last_pass_)) {
        deaths_by_share_.clear();
        for (Member& member : pool_) member.deaths_between_shares = 0;
    }
    last_pass_ = pass;
    active_workers_ = pass.workers;
    // A polling client would take processor time from the workers if there are no more cores than workers.
    max_spins_ = active_workers_ < available_cores() ? worker_timeouts::max_spins_for_pass_end : 0;
    needed_ = regions;
    failure_ = nullptr;
    forget_regions();
    restart_workers();
    for (unsigned slot = 0; slot < active_workers_; ++slot) send_regions(slot);
    publish_pass(pass);

    const std::stop_callback wake(watch.stop, [&] { view_.control_block().for_client.raise(); });
    changed_at_ = Clock::now();
    Clock::time_point next_check = Clock::now() + worker_timeouts::check_interval;
    for (bool over = false; !over;) {
        const std::uint32_t seen = view_.control_block().for_client.count.load();
        over = all_finished();
        const bool check = !over && Clock::now() >= next_check;
        if (check) next_check = Clock::now() + worker_timeouts::check_interval;
        try {
            poll(watch, over, check);
        } catch (...) {
            fail(std::current_exception());
        }
        if (!over && !check) view_.control_block().for_client.wait(seen, next_check - Clock::now(), max_spins_);
    }
    if (failure_ != nullptr) std::rethrow_exception(std::exchange(failure_, nullptr));
    shares_ = view_.slot(0).shares;
    return number_;
}

/// Handles new results and a stop request. `over`: all workers have finished. `check`: also check that the workers are alive.
void WorkerPool::poll(const PassWatch& watch, bool over, bool check) {
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        if (failure_ == nullptr && finished(slot) && view_.slot(slot).outcome != Outcome::done) fail_as_worker(slot);
    }
    if (failure_ == nullptr) {
        if (watch.stop.stop_requested() && !over) throw Error(ErrorCode::cancelled, "cancelled");
        if (watch.poll) watch.poll();
    }
    if (check) check_members(watch);
}

bool WorkerPool::finished(unsigned slot) const { return view_.slot(slot).finished.load() == number_; }

/// Returns true if all active workers have finished the pass. A slot without a process counts as finished.
bool WorkerPool::all_finished() const {
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        if (pool_[slot].process != nullptr && !finished(slot)) return false;
    }
    return true;
}

void WorkerPool::check_members(const PassWatch& watch) {
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        Member& member = pool_[slot];
        if (member.process == nullptr) continue;
        const ProcessState state = member.process->poll_state();
        if (state == ProcessState::runs) {
            const bool attached = view_.slot(slot).attached.load() != 0;
            if (attached) member.failed_starts = 0;
            if (attached || Clock::now() - member.started_at < worker_timeouts::attach_timeout) continue;
        }
        handle_lost_worker(slot, state != ProcessState::ended, watch);
    }
    if (failure_ != nullptr && Clock::now() - failed_at_ > worker_timeouts::pass_exit_timeout)
        kill_unresponsive_workers();
    if (failure_ == nullptr) check_deadlock();
}

/// Fails the pass if all workers wait for each other. A worker that died may have left such a state in the shared tables.
void WorkerPool::check_deadlock() {
    const std::uint64_t now = events();
    if (now != last_events_ || !all_wait()) {
        last_events_ = now;
        changed_at_ = Clock::now();
    } else if (Clock::now() - changed_at_ > worker_timeouts::deadlock_timeout) {
        fail(std::make_exception_ptr(Error(
            ErrorCode::engine_failed, "worker processes wait for each other: no work was done for " +
                                          std::to_string(worker_timeouts::deadlock_timeout.count() / 1000) + " s")));
    }
}

bool WorkerPool::all_wait() const {
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        if (!finished(slot) && view_.slot(slot).waits.load() == 0) return false;
    }
    return true;
}

/// Activity counter of the pass, used to detect a deadlock among the workers.
std::uint64_t WorkerPool::events() const {
    std::uint64_t events =
        view_.control_block().among_workers.count.load() + view_.control_block().for_client.count.load();
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        const Slot& part = view_.slot(slot);
        events += part.command.count.load() + part.ring_filled.load() + part.ring_taken.load() + part.share.load();
    }
    return events;
}

/// Ends a lost worker: one that died, is stopped (`stopped`) or did not attach in time. Starts its replacement.
void WorkerPool::handle_lost_worker(unsigned slot, bool stopped, const PassWatch& watch) {
    Member& member = pool_[slot];
    const bool attached = view_.slot(slot).attached.load() != 0;
    const ProcessEnd end = member.process->end();
    member.process = nullptr;
    count_fault(stopped ? faults_.stopped : faults_.ended);
    try {
        member.failed_starts = attached ? 0 : member.failed_starts + 1;
        if (member.failed_starts >= worker_failures::max_failed_starts) {
            member.failed_starts = 0;
            throw_cannot_start(end);
        }
        if (finished(slot)) return;
        if (attached) count_death(slot);
        if (failure_ != nullptr) return;
        if (watch.on_worker_lost) watch.on_worker_lost(slot);
        Slot& part = view_.slot(slot);
        view_.control_block().pass = last_pass_;
        part.share.store(0);
        part.preparing.store(1);
        start(slot);
        send_regions(slot);
        part.command.raise();
    } catch (...) {
        fail(std::current_exception());
    }
}

/// Counts the death of a slot's worker for the share that it was running.
/// Throws: Error{engine_failed} if too many workers died in that share.
void WorkerPool::count_death(unsigned slot) {
    const Slot& part = view_.slot(slot);
    std::uint64_t share = part.share.load();
    Step step = Step::prepare;
    if (share > 0 && share <= max_shares) {
        const Share& record = view_.shares(share - 1, 1)[0];
        const ShareState state = ShareState::of(record.state.load());
        const bool is_running = state.is(number_, ShareStatus::claimed) && state.slot == slot;
        const std::uint32_t number = record.step.load();
        if (!is_running || number >= step_names.size()) return check_crash_loop(slot);
        step = Step(number);
        count_fault(faults_.in_share[std::size_t(step)]);
    } else {
        if (part.preparing.load() == 0) return check_crash_loop(slot);
        share = preparing - slot;
    }
    if (++deaths_by_share_[share] < worker_failures::max_deaths_per_share) return;
    throw Error(ErrorCode::engine_failed, std::to_string(worker_failures::max_deaths_per_share) +
                                              " worker processes died in the same share of step " +
                                              step_names[std::size_t(step)]);
}

/// Throws: Error{engine_failed} if too many consecutive workers of a slot died outside any share.
void WorkerPool::check_crash_loop(unsigned slot) {
    Member& member = pool_[slot];
    member.deaths_between_shares =
        Clock::now() - member.started_at > worker_timeouts::healthy_lifetime ? 1 : member.deaths_between_shares + 1;
    if (member.deaths_between_shares < worker_failures::max_deaths_between_shares) return;
    throw Error(ErrorCode::engine_failed, "worker processes die repeatedly outside any share");
}

/// Fails the pass and sends its workers a stop message. Later failures of the pass are ignored.
void WorkerPool::fail(std::exception_ptr failure) {
    if (failure_ != nullptr) return;
    failure_ = std::move(failure);
    failed_at_ = Clock::now();
    view_.control_block().stopped.store(number_);
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        if (pool_[slot].process != nullptr) (void)pool_[slot].process->stop_pass(number_);
    }
}

/// Fails the pass with the error of a slot's worker.
void WorkerPool::fail_as_worker(unsigned slot) {
    const Slot& part = view_.slot(slot);
    std::string message(part.message.data(), strnlen(part.message.data(), part.message.size()));
    if (message.empty()) message = "a worker process failed without an error message";
    switch (part.outcome) {
        case Outcome::bad_box:
            return fail(std::make_exception_ptr(LinearOctree::Invalid{std::size_t(part.number)}));
        case Outcome::over_budget:
            if (last_pass_.kind == PassKind::list_ascending) return fail(std::make_exception_ptr(OverBudget{}));
            break;
        default:
            break;
    }
    const bool known = part.error_code <= unsigned(ErrorCode::cancelled) && part.outcome == Outcome::failed;
    fail(std::make_exception_ptr(Error(known ? ErrorCode(part.error_code) : ErrorCode::engine_failed, message)));
}

/// Kills workers that are still in a failed pass.
void WorkerPool::kill_unresponsive_workers() {
    for (unsigned slot = 0; slot < active_workers_; ++slot) {
        if (pool_[slot].process == nullptr || finished(slot)) continue;
        pool_[slot].process = nullptr;
        count_fault(faults_.stopped);
    }
}

void WorkerPool::send_regions(unsigned slot) {
    for (const auto& region : needed_) {
        if (pool_[slot].process->send_region(region->number, region->memory)) continue;
        // The worker has just ended, or no longer reads its messages and is therefore killed.
        (void)pool_[slot].process->end();
        return;
    }
}

void WorkerPool::forget_regions() {
    std::erase_if(regions_, [](const auto& region) { return region.expired(); });
    for (Member& member : pool_) {
        if (member.process == nullptr) continue;
        member.process->forget_all_but([&](std::uint32_t number) {
            return number == control_region || std::any_of(regions_.begin(), regions_.end(), [&](const auto& weak) {
                       const auto region = weak.lock();
                       return region != nullptr && region->number == number;
                   });
        });
    }
}

}  // namespace octopair
