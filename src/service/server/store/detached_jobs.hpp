// DetachedJobs: the jobs that outlive their calls and the server: submitted, found again at the server's start, released.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "service/server/server_context.hpp"
#include "service/server/jobs/watchdog.hpp"
#include "service/server/store/stored_job.hpp"

namespace octopair::service {

/// A job on its way to the disk.
struct Submission {
    ClientCounts::Place place;
    std::unique_ptr<StoredUpload> upload;
};

class DetachedJobs final : public Watched {
public:
    explicit DetachedJobs(ServerContext& server) : server_(server) {}

    /// Enters the jobs of the state folder: those without a result are queued again.
    void restore();

    /// A job with room for its input, within all limits. Throws a LimitError, Error{bad_input}, Error{io_failed}.
    Submission begin(const std::string& owner, v1::JobSpec spec);
    /// Its input is complete. When it returns, the job is on the disk, and queued; or it is the job that its owner had
    /// submitted under this id before. Throws Error{bad_input} if that one is another. As an errand.
    std::shared_ptr<ServerJob> commit(Submission& submission);
    /// Forgets a job that has ended; as an errand.
    void release(const ServerJob& job);

    /// Forgets those that ended longer ago than they are kept.
    void look(std::chrono::steady_clock::time_point now) override;
    /// Stops what runs; it is for the next server.
    void abandon();

private:
    void restore(StateFolder::Found found);
    std::shared_ptr<ServerJob> find_same(const StoredUpload& upload) const;
    Submission begin_job(const std::string& owner, v1::JobSpec spec);
    std::shared_ptr<ServerJob> make_job(StoredJob::Parts parts, ClientCounts::Place place) const;
    void set_queued(ServerJob& job) const;
    PairsInFile::Place pairs_of(const std::string& base, const std::string& hash) const;

    ServerContext& server_;
    std::chrono::steady_clock::time_point looked_{};  // the watchdog's
};

}  // namespace octopair::service
