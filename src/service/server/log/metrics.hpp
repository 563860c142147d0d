// Metrics: what a server counts, and what it shows to Prometheus over HTTP (docs/server.md lists them).
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

/// What is asked for when somebody looks.
struct Levels {
    std::uint64_t queue = 0, connections = 0, connections_refused = 0, memory_bytes = 0, worker_faults = 0;
};

/// Thread-safe.
class Metrics {
public:
    Metrics();
    Metrics(const Metrics&) = delete;
    Metrics& operator=(const Metrics&) = delete;
    ~Metrics();

    /// A job went from one state to another; none: it is new.
    void job_moved(std::optional<v1::JobState> from, v1::JobState to);
    /// `seconds`: that it ran.
    void job_ended(const v1::JobReport& report, double seconds);
    /// By the limit of that name.
    void refused(const std::string& limit);
    /// By reason: "unauthenticated", "going down".
    void call_refused(const std::string& reason);
    void received(std::uint64_t bytes);
    void sent(std::uint64_t bytes);

    /// `levels` is called from a thread of its own, until this goes or `hide` is called. Returns the port. Throws
    /// Error{usage} for an address that is not loopback, Error{io_failed} if it cannot be had.
    int show(const Address& address, std::function<Levels()> levels);
    void hide();

private:
    struct Store;
    class Look;
    std::unique_ptr<Store> store_;
};

}  // namespace octopair::service
