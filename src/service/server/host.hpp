// Host: what all calls of a server share.
#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <memory>
#include <string>

#include "service/protocol/limit_error.hpp"
#include "service/server/calls/call_threads.hpp"
#include "service/server/jobs/budget.hpp"
#include "service/server/jobs/job_table.hpp"
#include "service/server/jobs/lanes.hpp"
#include "service/server/jobs/overseer.hpp"
#include "service/server/jobs/server_job.hpp"
#include "service/server/jobs/spare_boxes.hpp"
#include "service/server/log/ledger.hpp"
#include "service/server/net/access.hpp"
#include "service/server/server_options.hpp"

namespace octopair::service {

class DetachedJobs;
class StateFolder;

class Host {
public:
    explicit Host(const ServerOptions& options, std::shared_ptr<spdlog::logger> log);
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;
    ~Host();

    const ServerOptions options;
    const std::shared_ptr<spdlog::logger> log;
    const Access access;
    Ledger ledger;
    Budget memory;
    SpareBoxes spares;
    ClientCounts places;
    const std::unique_ptr<StateFolder> state;  // none: there are no detached jobs
    JobTable jobs;
    Overseer overseer;
    CallThreads threads;
    std::shared_ptr<DetachedJobs> detached;  // none without a state folder
    std::atomic<bool> draining = false;
    /// Each attached job has a share of 1 from when its input is complete until its call is over.
    Budget attached;

    /// Who calls, if the call is let in: not while the server is going down.
    grpc::Status let_in(const grpc::ServerContextBase& context, std::string& owner);

    /// A job with room for its input, within all limits; attached. Throws a LimitError, or Error{bad_input}.
    std::shared_ptr<ServerJob> begin(const std::string& owner, v1::JobSpec spec);
    /// A job of which the ledger is told when it changes; not that it is there.
    std::shared_ptr<ServerJob> make_job(ServerJob::Parts parts);
    /// What `make` returns; that a limit refuses it is told to the ledger.
    template <typename Make>
    auto within_limits(const std::string& owner, Make&& make) {
        try {
            return make();
        } catch (const LimitError& error) {
            ledger.limit_refused(owner, error);
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

    Lanes lanes;  // the last, so that it ends first
};

}  // namespace octopair::service
