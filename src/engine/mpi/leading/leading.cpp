#include "engine/mpi/leading/leading.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
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

/// What each rank has, whether it leads or follows.
class RankGroup {
public:
    RankGroup(MPI_Comm comm, const LeadingOptions& options)
        : told_(comm),
          searched_(comm),
          heartbeat_(told_, options.silence),
          search_(searched_, {.threads = options.threads}, [this] { heartbeat_.beat(); }) {}

    Communicator& told() { return told_; }
    Heartbeat& heartbeat() { return heartbeat_; }
    /// Rank 0 gives the assignment, the others get it.
    void tell(Assignment& assignment) { told_.broadcast(std::span(&assignment, 1), 0); }
    /// A call has begun: until it is over, ranks that wait show that they do.
    void begin() {
        heartbeat_.begin();
        told_.set_meanwhile([this] { heartbeat_.beat(); });
    }
    /// Collective. `request`: on rank 0, null on the others.
    Summary find(const Assignment& assignment, const detail::Request* request, const detail::Output& output,
                 const detail::Control& control);

private:
    Communicator told_, searched_;  // of what is told and dealt out, and of the search
    SliceDistribution slices_{told_};
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

/// What the caller's functions threw. Ranks tell each other but the words of it; the caller shall have it as it was.
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
    Leader(MPI_Comm comm, const LeadingOptions& options) : group_(comm, options), lost_(options.lost) {}
    Leader(const Leader&) = delete;
    Leader& operator=(const Leader&) = delete;
    ~Leader();

    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control);

private:
    void look_for_lost();

    RankGroup group_;
    std::function<void(const std::string&)> lost_;
};

/// The others end with it.
Leader::~Leader() {
    if (group_.heartbeat().lost()) return;
    try {
        group_.begin();
        Assignment none;
        group_.tell(none);
        group_.heartbeat().end();
    } catch (const std::exception&) {
        look_for_lost();
    }
}

void Leader::look_for_lost() {
    if (group_.heartbeat().lost() && lost_) lost_(*group_.heartbeat().lost());
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
        group_.tell(assignment);
        summary = group_.find(assignment, &request, {output.list, output.sink == nullptr ? nullptr : &sink},
                                {control.stop, progress});
    } catch (...) {
        look_for_lost();
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
    detail::JobQueue jobs_{*this};  // the last, so that it ends first
};

/// Whoever waits for long sleeps for long, but no longer than a person notices.
class Backoff {
public:
    void operator()() const {
        constexpr std::chrono::milliseconds awake(1), longest(5);
        const auto waited = std::chrono::steady_clock::now() - begun_;
        if (waited > awake) std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(waited / 8, longest));
    }

private:
    std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

/// A rank that is not the first.
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
        group_.told().set_meanwhile(Backoff());
        group_.tell(next);
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
            return;  // rank 0 tells it to its caller
        }
    }

    RankGroup group_;
};

}  // namespace

void check_leading_threads() {
    int level = 0;
    MPI_Query_thread(&level);
    if (level >= MPI_THREAD_SERIALIZED) return;
    throw Error(ErrorCode::engine_failed, "MPI allows calls from one thread alone (no MPI_THREAD_SERIALIZED)");
}

std::unique_ptr<Engine> make_leading_engine(MPI_Comm comm, const LeadingOptions& options) {
    return std::make_unique<LeadingEngine>(comm, options);
}

void follow(MPI_Comm comm, const LeadingOptions& options) { Follower(comm, options).run(); }

}  // namespace octopair
