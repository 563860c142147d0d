// ServerContext: what all calls of a server share.
#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <memory>
#include <string>

#include "service/protocol/limit_error.hpp"
#include "service/server/calls/call_threads.hpp"
#include "service/server/jobs/budget.hpp"
#include "service/server/jobs/job_table.hpp"
#include "service/server/jobs/job_scheduler.hpp"
#include "service/server/jobs/watchdog.hpp"
#include "service/server/jobs/server_job.hpp"
#include "service/server/jobs/array_pool.hpp"
#include "service/server/log/server_log.hpp"
#include "service/server/net/access.hpp"
#include "service/server/server_options.hpp"

namespace octopair::service {

class DetachedJobs;
class StateFolder;

class ServerContext {
public:
    explicit ServerContext(const ServerOptions& options, std::shared_ptr<spdlog::logger> log);
    ServerContext(const ServerContext&) = delete;
    ServerContext& operator=(const ServerContext&) = delete;
    ~ServerContext();

    const ServerOptions options;
    const std::shared_ptr<spdlog::logger> log;
    const Access access;
    ServerLog server_log;
    Budget memory;
    ArrayPool array_pool;
    ClientCounts places;
    const std::unique_ptr<StateFolder> state;  // none: there are no detached jobs
    JobTable jobs;
    Watchdog watchdog;
    CallThreads threads;
    std::shared_ptr<DetachedJobs> detached;  // none without a state folder
    std::atomic<bool> draining = false;
    /// Each attached job has a share of 1 from when its input is complete until its call is over.
    Budget attached;

    /// Who calls, if the call is let in: not while the server is going down.
    grpc::Status let_in(const grpc::ServerContextBase& context, std::string& owner);

    /// A job with room for its input, within all limits; attached. Throws a LimitError, or Error{bad_input}.
    std::shared_ptr<ServerJob> begin(const std::string& owner, v1::JobSpec spec);
    /// A job of which the server_log is told when it changes; not that it is there.
    std::shared_ptr<ServerJob> make_job(ServerJob::Parts parts);
    /// What `make` returns; that a limit refuses it is told to the server_log.
    template <typename Make>
    auto within_limits(const std::string& owner, Make&& make) {
        try {
            return make();
        } catch (const LimitError& error) {
            server_log.limit_refused(owner, error);
            throw;
        }
    }
    /// Throws a LimitError, or Error{bad_input}: no job may ask that.
    void check_limits(const v1::JobSpec& spec) const;
    /// For a call whose client took too long in the middle of an upload.
    grpc::Status refuse_stalled(const std::string& owner);
    /// What a job takes while it runs, beside its result.
    static std::uint64_t memory_of(const v1::JobSpec& spec);
    /// Of a job, with its place in the queue.
    v1::JobReport report(const ServerJob& job) const;
    /// Its input is complete: it waits for its turn.
    void queue(const std::shared_ptr<ServerJob>& job);
    /// No attached job is queued, runs, or has a result that is on its way, and no detached one runs.
    bool idle() const;

    JobScheduler scheduler;  // the last, so that it ends first
};

}  // namespace octopair::service
