// ServerLog: records the events of a server in its log and its metrics. Clients appear by name; the log contains no tokens or
// keys.
#pragma once

#include <spdlog/fwd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "service/server/log/metrics.hpp"

namespace grpc {
class Status;
}  // namespace grpc

namespace octopair::service {

class LimitError;
class ServerJob;

/// Thread safety: safe.
class ServerLog {
public:
    explicit ServerLog(std::shared_ptr<spdlog::logger> log) : log_(std::move(log)) {}

    /// Records a change of state of a job. `from`: empty for a new job.
    void job_state_changed(const ServerJob& job, std::optional<v1::JobState> from, v1::JobState to);
    /// Records a request that exceeded a limit.
    void limit_refused(const std::string& owner, const LimitError& error);
    /// Records refused connections. `allowed`: limit of connections. `refused`: number of connections refused since the start.
    void connections_refused(std::uint64_t allowed, std::uint64_t refused);
    /// Records a call that was not admitted. `peer`: the caller's address as gRPC writes it. At most one line a second: the next line says how
    /// many were left out.
    void call_refused(const std::string& peer, const grpc::Status& why);
    void received(std::uint64_t bytes) { metrics_.received(bytes); }
    void sent(std::uint64_t bytes) { metrics_.sent(bytes); }

    Metrics& metrics() { return metrics_; }

private:
    const std::shared_ptr<spdlog::logger> log_;
    Metrics metrics_;
    std::mutex mutex_;
    std::chrono::steady_clock::time_point last_refusal_{};  // time of the last line about a refused call
    std::uint64_t unreported_ = 0;                          // refused calls since that line
};

}  // namespace octopair::service
