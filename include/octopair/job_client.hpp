// JobClient: submits detached jobs to a server (`octopair serve --state DIR`) and collects their results later, from any
// machine.
//
// Result    The same bytes as from every engine (engine.hpp). The server keeps a result until it is released, or until the
//           server's retention time has passed.
// Roles     A server can give a client another role than owner (docs/server.md). A reader sees the jobs of one owner, and reads
//           their results. An operator sees and cancels the jobs of all owners, and can end the server. Calls that a role does not
//           allow throw Error{usage}.
// Jobs      A submitted job is on the server's disk: it completes even if the client ends or the server restarts. Only its
//           owner sees it. All clients with the same token or certificate are one owner; so are all clients of a server that
//           requires neither.
// Faults    If the server becomes unreachable, a call repeats its request until the server answers or
//           ClientOptions::patience has passed. Before the first contact, the call waits at most ClientOptions::connect_timeout.
//           Nevertheless a job is submitted once, and a sink receives each pair once.
// Errors    octopair::Error, as from connect() (client.hpp). Error{bad_input} for an unknown job; Error{usage} if the server
//           takes no detached jobs; Error{resource_limit} that names the server's limit; Error{cancelled} after a stop
//           request. result() throws the job's Error, and Error{cancelled} for a cancelled job.
// Threads   Several threads may use a client at once.
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

namespace [[gnu::visibility("default")]] octopair {

/// State of a job on the server.
struct JobStatus {
    std::string id;
    JobState state = JobState::queued;
    bool detached = false;            ///< false: a job of a direct call, whose client waits for the result
    bool count_only = false;          ///< true: pairs are only counted; the result is the summary
    double progress = 0;              ///< fraction of the work that is done, 0 to 1
    std::uint64_t queued_before = 0;  ///< number of jobs that run before this one
    std::uint64_t objects = 0;        ///< number of objects
    Summary summary = {};             ///< valid if the job is done
    std::optional<Error> error = {};  ///< set if the job failed
    std::string owner = {};           ///< name of the client that submitted the job; empty: this client
    bool waits_for_room = false;      ///< the job is queued until the server's disk has room for its result

    bool ended() const { return state != JobState::queued && state != JobState::running; }
};

/// Settings of a job, besides Options.
struct JobTerms {
    std::string id = {};      ///< lower-case UUID; empty: the client chooses a random id
    bool count_only = false;  ///< true: counts the pairs and stores none
};

class JobClient {
public:
    /// Takes the arguments of connect() (client.hpp). Does not connect yet. Throws: as connect(), except for an unreachable
    /// server.
    explicit JobClient(std::string_view address, const ClientOptions& options = {});
    JobClient(const JobClient&) = delete;
    JobClient& operator=(const JobClient&) = delete;
    ~JobClient();

    /// Stores a job on the server's disk and returns its id. If a job with this id exists, no second job is made.
    /// `Options::progress` receives the progress of the upload.
    /// Throws: Error{bad_input} if a job with this id has other input or options; Error{usage} for `Options::verify`, because
    /// the client that collects the result may not have the objects.
    std::string submit(const Input& input, const Options& options = {}, const JobTerms& terms = {},
                       std::stop_token stop = {});

    JobStatus status(const std::string& id, std::stop_token stop = {});
    /// Waits until the job has ended, but at most for `most`. Returns its status.
    JobStatus wait(const std::string& id, std::chrono::duration<double> most, std::stop_token stop = {});
    /// Cancels the job, waits at most 10 s until it has ended, and returns its status.
    JobStatus cancel(const std::string& id, std::stop_token stop = {});
    /// Deletes a job that has ended, and its result.
    void release(const std::string& id, std::stop_token stop = {});
    /// Returns the status of all jobs that the client sees, ascending by owner and id. Includes jobs of direct calls.
    std::vector<JobStatus> list(std::stop_token stop = {});
    /// Starts the shutdown of the server, as SIGTERM does. Requires the role operator.
    void drain(std::stop_token stop = {});

    /// Receives the pairs while the server finds them, and returns the summary when the job is done. The result stays on the
    /// server. A count-only job delivers no pairs.
    Summary result(const std::string& id, PairList& pairs, const ProgressSink& progress = {},
                   std::stop_token stop = {});
    Summary result(const std::string& id, const PairSink& sink, const ProgressSink& progress = {},
                   std::stop_token stop = {});

private:
    class [[gnu::visibility("hidden")]] State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair
