// JobClient: detached jobs of a server (`octopair serve --state DIR`): submitted now, collected later, from anywhere.
//
// Result    the same bytes as from every engine (engine.hpp).
// Jobs      a job that was submitted is on the server's disk: it is done whatever becomes of client and server. It is its
//           owner's alone: of who has the same token or certificate, or, where the server wants neither, of all. Its
//           result waits there until it is released, or has waited as long as the server keeps results.
// Faults    a server that goes away in the middle of a call is waited for and asked again, as long as
//           ClientOptions::patience: a job is submitted once, and a sink receives each pair once nevertheless. One
//           that was never there is waited for as long as ClientOptions::connect_timeout.
// Errors    octopair::Error: as connect (client.hpp); Error{bad_input} if there is no such job, Error{usage} if the server
//           takes no detached jobs, Error{resource_limit} that names the server's limit; where a result is asked for, what the
//           job failed with, Error{cancelled} for a job that was cancelled, and on a stop.
// Threads   a client may be used from several threads at once.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/client.hpp"
#include "octopair/engine.hpp"
#include "octopair/error.hpp"
#include "octopair/input.hpp"
#include "octopair/job.hpp"

namespace octopair {

/// How a job stands on the server.
struct JobStatus {
    std::string id;
    JobState state = JobState::queued;
    bool detached = false;            ///< else the job of a call that waits for it
    bool count_only = false;          ///< its pairs are counted alone: the summary is its result
    double progress = 0;              ///< of the work, 0 to 1
    std::uint64_t queued_before = 0;  ///< others that run before it
    std::uint64_t objects = 0;
    Summary summary = {};             ///< of a job that is done
    std::optional<Error> error = {};  ///< of one that failed

    bool ended() const { return state != JobState::queued && state != JobState::running; }
};

/// Of a job that is submitted.
struct JobTerms {
    std::string id = {};      ///< a UUID in small letters; empty: a random one
    bool count_only = false;  ///< the number of pairs alone
};

class JobClient {
public:
    /// As connect, but does not connect yet.
    explicit JobClient(std::string_view address, const ClientOptions& options = {});
    JobClient(const JobClient&) = delete;
    JobClient& operator=(const JobClient&) = delete;
    ~JobClient();

    /// Returns the job's id when it is on the server's disk. A job that was submitted under this id before is the same one;
    /// Error{bad_input} if its input or options are others. `Options::progress` is of the upload;
    /// Error{usage} for `Options::verify`: who collects the result need not have the objects.
    std::string submit(const Input& input, const Options& options = {}, const JobTerms& terms = {},
                       std::stop_token stop = {});

    JobStatus status(const std::string& id, std::stop_token stop = {});
    /// Returns when the job has ended, or after the given time.
    JobStatus wait(const std::string& id, std::chrono::duration<double> most, std::stop_token stop = {});
    /// Returns when the job has ended, or after 10 s.
    JobStatus cancel(const std::string& id, std::stop_token stop = {});
    /// Forgets a job that has ended, and its result.
    void release(const std::string& id, std::stop_token stop = {});
    /// The caller's own jobs, ascending by id; those of calls too.
    std::vector<JobStatus> list(std::stop_token stop = {});

    /// Waits for the pairs as they are found; the result stays on the server. Those of a job that counts are none.
    Summary result(const std::string& id, PairList& pairs, const ProgressSink& progress = {},
                   std::stop_token stop = {});
    Summary result(const std::string& id, const PairSink& sink, const ProgressSink& progress = {},
                   std::stop_token stop = {});

private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair
