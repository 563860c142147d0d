// ServerLog: records the events of a server in its log and its metrics. Clients appear by name; the log contains no tokens or
// keys.
#pragma once

#include <spdlog/fwd.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "service/server/log/metrics.hpp"

namespace grpc {
class ServerContextBase;
class Status;
}  // namespace grpc

namespace octopair::service {

/// Limits the log to one line a second for each key, and counts the omitted lines. Thread safety: any thread may call it.
class Throttle {
public:
    using Clock = std::chrono::steady_clock;

    /// Returns nothing if the log must omit this line. Otherwise returns the number of omitted lines since the last line with this key.
    std::optional<std::uint64_t> pass(const std::string& key, Clock::time_point now = Clock::now()) {
        constexpr std::chrono::seconds apart(1);
        constexpr std::size_t most = 1000;
        const std::lock_guard lock(mutex_);
        if (keys_.size() >= most)
            std::erase_if(keys_, [&](const auto& known) { return now - known.second.last >= apart; });
        if (keys_.size() >= most && !keys_.contains(key)) return {};
        Key& known = keys_[key];
        if (known.last != Clock::time_point() && now - known.last < apart) {
            ++known.left_out;
            return {};
        }
        known.last = now;
        return std::exchange(known.left_out, 0);
    }

private:
    struct Key {
        Clock::time_point last{};
        std::uint64_t left_out = 0;
    };

    std::mutex mutex_;
    std::map<std::string, Key> keys_;
};

class LimitError;
class ServerJob;

/// Client that makes a call, and its address as gRPC writes it.
struct Asker {
    const std::string& client;
    std::string peer;
};

/// The part of a result that a call sent.
struct Sent {
    std::uint64_t offset = 0, bytes = 0;
    std::string outcome;  ///< "complete", or the reason why the call ended early
};

/// Thread safety: any thread may call it.
class ServerLog {
public:
    explicit ServerLog(std::shared_ptr<spdlog::logger> log) : log_(std::move(log)) {}

    /// Records a change of state of a job. `from`: empty for a new job.
    void job_state_changed(const ServerJob& job, std::optional<v1::JobState> from, v1::JobState to);
    /// Records that `call` received an attached job, or stored a detached job on the disk.
    void job_submitted(const ServerJob& job, const grpc::ServerContextBase& call);
    /// Records a call about a job. `call`: "cancel" or "release".
    void job_asked(const char* call, const ServerJob& job, const Asker& asker);
    /// Records the end of a call that sent the result of a detached job, from pair `offset` on. `bytes`: size of its messages.
    void result_sent(const ServerJob& job, const Asker& asker, const Sent& sent);
    /// Records a request that exceeded a limit. At most one line a second for each client; the next line has the number of omitted lines.
    void limit_refused(const std::string& client, const LimitError& error);
    /// Records refused connections. `allowed`: limit of connections. `refused`: number of connections refused since the start.
    void connections_refused(std::uint64_t allowed, std::uint64_t refused);
    /// Records a connection. `client`: client of its first call; empty: not known yet.
    void connected(const std::string& peer, const std::string& client);
    /// Records a call that was not admitted. The client of `asker` is empty unless it is authenticated. At most one line a second for each
    /// authenticated client, and for all other callers together. The next line has the number of omitted lines.
    void call_refused(const Asker& asker, const grpc::Status& why);
    /// Records a call that was admitted, but made no job. At most one line a second for each client.
    void call_failed(const Asker& asker, const grpc::Status& why);
    /// Records that a client asked the server to end.
    void drain_asked(const Asker& asker);
    void received(std::uint64_t bytes) { metrics_.received(bytes); }
    void sent(std::uint64_t bytes) { metrics_.sent(bytes); }

    Metrics& metrics() { return metrics_; }

private:
    const std::shared_ptr<spdlog::logger> log_;
    Metrics metrics_;
    Throttle refused_calls_, refused_clients_, failed_clients_;
};

}  // namespace octopair::service
