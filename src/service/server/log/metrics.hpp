// Metrics: counters and gauges of a server, served to Prometheus over HTTP (docs/server.md lists them).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "service/protocol/address.hpp"

namespace octopair::v1 {
class JobReport;
enum JobState : int;
}  // namespace octopair::v1

namespace octopair::service {

/// Gauges that the server computes at each HTTP request.
struct Levels {
    std::uint64_t queue = 0, connections = 0, connections_refused = 0, memory_bytes = 0, worker_faults = 0;
};

/// Thread safety: any thread may call it.
class Metrics {
public:
    Metrics();
    Metrics(const Metrics&) = delete;
    Metrics& operator=(const Metrics&) = delete;
    ~Metrics();

    /// Counts a change of state of a job. `from`: empty for a new job.
    void job_state_changed(std::optional<v1::JobState> from, v1::JobState to);
    /// Counts a job that starts to run, after it has waited for an engine.
    void job_started(double queue_seconds);
    /// Counts an ended job. `seconds`: run time of the job; 0: it did not run.
    void job_ended(const v1::JobReport& report, double seconds);
    /// Counts a request that exceeded a limit. `limit`: name of this limit.
    void refused(const std::string& limit);
    struct ClientJob {
        double seconds = 0;
        std::uint64_t bytes = 0;  ///< size of the input
        std::uint64_t pairs = 0;
    };
    /// Counts an ended job of a client. Each of the first 50 clients has its own counters. All further clients share the counters "other".
    void client_job_ended(const std::string& client, const ClientJob& job);
    /// Counts a request of this client that exceeded a limit.
    void client_refused(const std::string& client);
    /// Counts a refused call. `reason`: "unauthenticated", "not permitted" or "going down".
    void call_refused(const std::string& reason);
    void received(std::uint64_t bytes);
    void sent(std::uint64_t bytes);

    /// Starts to serve the metrics at `address` and returns the port. `levels` is called on a thread of the HTTP server, until
    /// hide() or the destructor is called. Throws: Error{usage} for an address that is not loopback, Error{io_failed} if
    /// listening fails.
    int show(const Address& address, std::function<Levels()> levels);
    /// Stops the HTTP server.
    void hide();

private:
    struct Store;
    class Collector;
    std::unique_ptr<Store> store_;
};

}  // namespace octopair::service
