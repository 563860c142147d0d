// ServerContext: the state that all calls of a server share: options, limits, jobs, log and scheduler.
#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "service/protocol/errors.hpp"
#include "service/server/calls/result_reader.hpp"
#include "service/server/jobs/array_pool.hpp"
#include "service/server/jobs/budget.hpp"
#include "service/server/jobs/job_scheduler.hpp"
#include "service/server/jobs/job_table.hpp"
#include "service/server/jobs/server_job.hpp"
#include "service/server/jobs/watchdog.hpp"
#include "service/server/log/server_log.hpp"
#include "service/server/net/access.hpp"
#include "service/server/scenes/scene_publisher.hpp"
#include "service/server/server_options.hpp"

namespace octopair::service {

class DetachedJobs;
class StateFolder;

/// Starts a thread for each call that needs its own. The destructor waits for all threads. Thread safety: any thread may call it.
class CallThreads {
public:
    CallThreads() = default;
    CallThreads(const CallThreads&) = delete;
    CallThreads& operator=(const CallThreads&) = delete;

    /// Runs `work` on a new thread. Requires: `work` does not throw. Throws: std::system_error if no thread can be created.
    void start(std::function<void()> work);

private:
    struct Running {
        std::atomic<bool> ended = false;
        std::jthread thread;
    };

    std::mutex mutex_;
    std::list<Running> running_;
};

/// An admitted call: its caller, and a reservation of one call of the client, which the destructor gives back.
struct Admission {
    Caller caller;
    Budget::Reservation call;

    const std::string& client() const { return caller.name; }
};

class ServerContext {
public:
    explicit ServerContext(const ServerOptions& options, std::shared_ptr<spdlog::logger> log);
    ServerContext(const ServerContext&) = delete;
    ServerContext& operator=(const ServerContext&) = delete;
    ~ServerContext();

    const ServerOptions options;
    const std::shared_ptr<spdlog::logger> log;
    Access access;
    ServerLog server_log;
    Budget memory;
    ArrayPool array_pool;
    Budget job_slots;                            // one slot for each unfinished job and each scene
    Budget calls;                                // number of calls at a time
    const std::uint64_t connections_per_client;  // over TCP; 0: no limit
    const std::unique_ptr<StateFolder> state;    // null: the server takes no detached jobs
    JobTable jobs;
    SceneTable scenes;
    Watchdog watchdog;
    CallThreads threads;
    ResultReader result_reader;
    std::shared_ptr<DetachedJobs> detached;  // null without a state folder
    std::atomic<bool> draining = false;
    /// Number of attached jobs that the server waits for when it shuts down. Each job reserves 1 from the end of its upload to
    /// the end of its call.
    Budget attached;

    /// Called with each call before it is admitted, and the name of its client; may be empty. Set before the first call. Throws:
    /// LimitError to refuse the call.
    std::function<void(const grpc::ServerContextBase&, const std::string& client)> on_call;

    /// Called with the peer of each call that is refused because its client is not known; may be empty. Set before the first call.
    std::function<void(const std::string& peer)> on_unknown;

    /// Authenticates the caller, checks that its role has `right`, and sets `admission`. Returns why a call is refused.
    grpc::Status admit(const grpc::ServerContextBase& context, Right right, Admission& admission);
    /// Returns the job that the caller names. `owner`: owner of the job, for callers that see the jobs of all. Throws:
    /// Error{bad_input} if the caller sees no such job.
    std::shared_ptr<ServerJob> find(const Caller& caller, const std::string& owner, const std::string& id) const;

    /// Creates an attached job and reserves memory for it. Throws: LimitError, Error{bad_input}.
    std::shared_ptr<ServerJob> begin(const std::string& owner, v1::JobSpec spec);
    /// Creates a job whose changes of state go to the log. The caller logs the creation.
    std::shared_ptr<ServerJob> make_job(ServerJob::Parts parts);
    /// Returns the result of `make`. Logs a LimitError that `make` throws.
    template <typename Make>
    auto within_limits(const std::string& owner, Make&& make) {
        try {
            return make();
        } catch (const LimitError& error) {
            server_log.limit_refused(owner, error);
            throw;
        }
    }
    /// Throws: Error{bad_input} for an invalid spec, LimitError for a spec beyond the limits on objects or input.
    void check_limits(const v1::JobSpec& spec) const;
    /// Logs that a client stalled in the middle of an upload, and returns the status that ends its call.
    grpc::Status refuse_stalled(const std::string& owner);
    /// Returns the memory in bytes that a job needs while it runs, without its result.
    static std::uint64_t memory_of(const v1::JobSpec& spec);
    /// Returns the job's report for a caller, with the number of jobs queued before it.
    v1::JobReport report(const ServerJob& job, const Caller& caller) const;
    /// Adds `job` to the scheduler and the watchdog. Requires: the input is complete.
    void queue(const std::shared_ptr<ServerJob>& job);
    /// Returns whether no attached job is queued, running or sending its result, and no detached job is running.
    bool idle() const;

    JobScheduler scheduler;  // last member: destroyed first, so that no job runs while the others are destroyed
};

}  // namespace octopair::service
