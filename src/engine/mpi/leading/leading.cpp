#include "engine/mpi/leading/leading.hpp"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <utility>

#include "base/stop.hpp"
#include "base/timed.hpp"
#include "engine/job_queue.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/comm/heartbeat.hpp"
#include "engine/mpi/leading/slice_distribution.hpp"
#include "engine/mpi/rank_search.hpp"
#include "engine/ticket_lock.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// State of a rank that leads or follows: communicators, heartbeat, slices and search.
class RankGroup {
public:
    RankGroup(MPI_Comm comm, const LeadingOptions& options)
        : control_comm_(comm),
          search_comm_(comm),
          heartbeat_(control_comm_, options.silence),
          search_(search_comm_, {.threads = options.threads}, [this] { heartbeat_.beat(); }) {}

    Communicator& control_comm() { return control_comm_; }
    Heartbeat& heartbeat() { return heartbeat_; }
    /// Collective. Copies the assignment of rank 0 to the other ranks.
    void broadcast(Assignment& assignment) { control_comm_.broadcast(std::span(&assignment, 1), 0); }
    /// Starts the heartbeat of a call. From now on a rank also beats while it waits.
    void begin() {
        heartbeat_.begin();
        control_comm_.set_wait_hook([this] { heartbeat_.beat(); });
    }
    /// Collective. Runs a call. `request`: null on all ranks but rank 0.
    Summary find(const Assignment& assignment, const detail::Request* request, const detail::Output& output,
                 const detail::Control& control);

private:
    Communicator control_comm_, search_comm_;  // `control_comm_`: for assignments, slices and heartbeats
    SliceDistribution slices_{control_comm_};
    Heartbeat heartbeat_;
    RankSearch search_;
};

Summary RankGroup::find(const Assignment& assignment, const detail::Request* request, const detail::Output& output,
                        const detail::Control& control) {
    slices_.make(assignment, request, control.stop);
    const Options options = assignment.options();
    const Objects* const second = assignment.join ? &slices_.slice(1) : nullptr;
    return search_.run({slices_.slice(0), second, options}, output, control, Recipients::first);
}

/// Calls the caller's functions, and keeps the first exception that they throw. Ranks exchange only its message, but the caller of
/// the engine must get the original exception.
class Captured {
public:
    template <typename... Arguments>
    std::function<void(Arguments...)> wrap(const std::function<void(Arguments...)>& function) {
        if (!function) return {};
        return [this, &function](Arguments... arguments) {
            try {
                function(arguments...);
            } catch (...) {
                const std::lock_guard lock(mutex_);
                if (!failure_) failure_ = std::current_exception();
                throw;
            }
        };
    }
    void rethrow() {
        const std::lock_guard lock(mutex_);
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    std::mutex mutex_;
    std::exception_ptr failure_;
};

[[noreturn]] void wait_for_stop(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    (void)stopped.wait(lock, stop, [] { return false; });
    throw Error(ErrorCode::cancelled, "cancelled");
}

class Leader {
public:
    Leader(MPI_Comm comm, const LeadingOptions& options)
        : group_(comm, options), on_silent_rank_(options.on_silent_rank) {}
    Leader(const Leader&) = delete;
    Leader& operator=(const Leader&) = delete;
    ~Leader();

    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control);

private:
    void report_lost_rank();

    RankGroup group_;
    std::function<void(const std::string&)> on_silent_rank_;
};

/// Ends follow() on the other ranks.
Leader::~Leader() {
    if (group_.heartbeat().lost()) return;
    try {
        group_.begin();
        Assignment none;
        group_.broadcast(none);
        group_.heartbeat().end();
    } catch (const std::exception&) {
        report_lost_rank();
    }
}

void Leader::report_lost_rank() {
    if (group_.heartbeat().lost() && on_silent_rank_) on_silent_rank_(*group_.heartbeat().lost());
}

Summary Leader::run(const detail::Request& request, const detail::Output& output, const detail::Control& control) {
    if (group_.heartbeat().lost()) wait_for_stop(control.stop);
    Summary summary;
    Captured captured;
    const ProgressSink progress = captured.wrap(control.progress);
    const PairSink sink = output.sink == nullptr ? PairSink() : captured.wrap(*output.sink);
    try {
        Assignment assignment = Assignment::of(request, output_kind_of(output));
        group_.begin();
        group_.broadcast(assignment);
        summary = group_.find(assignment, &request, {output.list, output.sink == nullptr ? nullptr : &sink},
                              {control.stop, progress});
    } catch (...) {
        report_lost_rank();
        captured.rethrow();
        throw;
    }
    return summary;
}

class LeadingEngine final : public Engine {
public:
    LeadingEngine(MPI_Comm comm, const LeadingOptions& options) : leader_(comm, options) {}

private:
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        const TicketLock::Guard turn(ticket_lock_, control.stop);
        double seconds = 0;
        Summary summary;
        {
            const Timed timed(seconds);
            summary = leader_.run(request, output, control);
        }
        summary.seconds = seconds;
        return summary;
    }
    detail::JobQueue& jobs() override { return jobs_; }

    TicketLock ticket_lock_;
    Leader leader_;
    detail::JobQueue jobs_{*this};  // last member, so that it is destroyed first
};

/// Runs the part of a rank other than rank 0 in the calls of the engine.
class Follower {
public:
    Follower(MPI_Comm comm, const LeadingOptions& options) : group_(comm, options) {}

    void run() {
        for (Assignment next = wait(); !next.end; next = wait()) take_part(next);
        group_.heartbeat().end();
    }

private:
    Assignment wait() {
        Assignment next;
        group_.control_comm().set_wait_hook(Backoff());
        group_.broadcast(next);
        group_.begin();
        return next;
    }

    void take_part(const Assignment& assignment) {
        PairList list;
        const PairSink nothing = [](std::span<const Pair>) {};
        const detail::Output output = {assignment.output_kind == OutputKind::list ? &list : nullptr,
                                       assignment.output_kind == OutputKind::sink ? &nothing : nullptr};
        const ProgressSink nobody;
        try {
            (void)group_.find(assignment, nullptr, output, {{}, nobody});
        } catch (const Error&) {
            return;  // rank 0 throws this Error to its caller, so this rank ignores it
        }
    }

    RankGroup group_;
};

}  // namespace

void check_leading_threads() {
    int level = 0;
    MPI_Query_thread(&level);
    if (level >= MPI_THREAD_SERIALIZED) return;
    throw Error(ErrorCode::engine_failed,
                "MPI allows calls from one thread only; this engine needs MPI_THREAD_SERIALIZED");
}

std::unique_ptr<Engine> make_leading_engine(MPI_Comm comm, const LeadingOptions& options) {
    return std::make_unique<LeadingEngine>(comm, options);
}

void follow(MPI_Comm comm, const LeadingOptions& options) { Follower(comm, options).run(); }

}  // namespace octopair
