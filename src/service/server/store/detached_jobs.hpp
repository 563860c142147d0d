// DetachedJobs: submits and releases detached jobs, which outlive their calls and the server, and restores them at a start.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "service/server/jobs/watchdog.hpp"
#include "service/server/server_context.hpp"
#include "service/server/store/stored_job.hpp"

namespace octopair::service {

/// A detached job whose input is being uploaded.
struct Submission {
    Budget::Reservation slot;
    std::unique_ptr<StoredUpload> upload;
};

class DetachedJobs final : public Watched {
public:
    explicit DetachedJobs(ServerContext& server) : server_(server) {}

    /// Adds the jobs of the state folder to the job table, and queues those without a result.
    void restore();

    /// Starts the upload of a job and reserves disk space for its input. Throws: LimitError, Error{bad_input},
    /// Error{io_failed}.
    Submission begin(const std::string& owner, v1::JobSpec spec);
    /// Writes the job to the disk, queues the job and returns it. If the owner already has a job with this id and hash, returns the older
    /// job. Returns null if the older job was released during the upload. Requires: the input is complete; called on the disk queue.
    /// Throws: Error{bad_input} if the existing job has another hash; Error{io_failed}.
    std::shared_ptr<ServerJob> commit(Submission& submission);
    /// Removes a job and its files. Requires: the job has ended; runs on the disk queue.
    void release(const ServerJob& job);

    /// Removes jobs that ended more than ServerOptions::keep ago.
    void check_deadline(std::chrono::steady_clock::time_point now) override;
    /// Stops running jobs without an ending, so that the next server runs them.
    void abandon();

private:
    void restore(StateFolder::Found found);
    std::optional<Error> upgrade(StateFolder::Found& found) const;
    std::shared_ptr<ServerJob> find_same(const StoredUpload& upload) const;
    Submission begin_job(const std::string& owner, v1::JobSpec spec);
    std::shared_ptr<ServerJob> make_job(StoredJob::Parts parts, Budget::Reservation slot) const;
    void set_queued(ServerJob& job) const;
    PairsInFile::Target result_target(const std::string& base, const StoredSpec& stored) const;

    ServerContext& server_;
    std::chrono::steady_clock::time_point last_check_{};  // used by the watchdog's thread only
};

}  // namespace octopair::service
