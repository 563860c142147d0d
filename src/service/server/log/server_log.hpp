// ServerLog: what a server writes down about its work, in its log and its metrics. No secrets: clients appear by name.
#pragma once

#include <spdlog/fwd.h>

#include <memory>
#include <optional>
#include <string>

#include "service/server/log/metrics.hpp"

namespace grpc {
class Status;
}  // namespace grpc

namespace octopair::service {

class LimitError;
class ServerJob;

/// Thread-safe.
class ServerLog {
public:
    explicit ServerLog(std::shared_ptr<spdlog::logger> log) : log_(std::move(log)) {}

    /// A job went from one state to another; none: it is new.
    void job_moved(const ServerJob& job, std::optional<v1::JobState> from, v1::JobState to);
    /// Somebody asked for more than a limit allows.
    void limit_refused(const std::string& owner, const LimitError& error);
    /// There are more connections than are allowed; `refused` were, since the start.
    void connections_refused(std::uint64_t allowed, std::uint64_t refused);
    /// A call was not let in. `peer`: as gRPC names it.
    void call_refused(const std::string& peer, const grpc::Status& why);
    void received(std::uint64_t bytes) { metrics_.received(bytes); }
    void sent(std::uint64_t bytes) { metrics_.sent(bytes); }

    Metrics& metrics() { return metrics_; }

private:
    const std::shared_ptr<spdlog::logger> log_;
    Metrics metrics_;
};

}  // namespace octopair::service
