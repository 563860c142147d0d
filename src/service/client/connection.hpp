// Connection: a gRPC channel to a server, with retries of calls while the server is unavailable.
#pragma once

#include <grpcpp/support/status.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>

#include "octopair/client.hpp"

namespace grpc {
class Channel;
class ClientContext;
}  // namespace grpc

namespace octopair::service {

/// Thread safety: all member functions may be called concurrently.
class Connection {
public:
    using Clock = std::chrono::steady_clock;

    /// Does not connect yet. Throws: as octopair::connect().
    Connection(std::string_view address, const ClientOptions& options);

    const std::string& server() const { return server_; }
    /// Returns the channel, for stubs. Stubs are cheap to create.
    const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }
    /// Adds the token to the context of a call. Required for every call.
    void prepare(grpc::ClientContext& context) const;
    /// Makes a Describe call, to check that the server is available. Throws: as call_with_retries().
    void check_server();

    /// Estimate, learned from earlier jobs: results of jobs with at most this many input bytes fit into one message.
    std::atomic<std::uint64_t>& small_input() { return small_input_; }

    /// Records that the server has sent something. This restarts the timeout of RetryTimer.
    void heard() {
        heard_ = Clock::now();
        met_ = true;
    }

    /// Calls attempt(), which makes one call and returns its status, until the status is not retryable.
    /// Retries end after ClientOptions::patience, or after `connect_timeout` if the server has never been available.
    /// Throws: the Error that the last status describes, unless it is OK; Error{cancelled} after a stop request.
    template <typename Attempt>
    void call_with_retries(const std::stop_token& stop, Attempt&& attempt) {
        for (RetryTimer retry(*this);;) {
            const grpc::Status status = attempt();
            if (status.ok()) return met();
            retry.wait_or_throw(status, stop);
        }
    }

private:
    /// Waits between the attempts of one call, and limits how long the server may be unavailable.
    class RetryTimer {
    public:
        explicit RetryTimer(Connection& connection) : connection_(connection) {}
        /// Waits until the next attempt.
        /// Throws: Error if `status` is not retryable or the timeout has passed; Error{cancelled} after a stop request.
        void wait_or_throw(const grpc::Status& status, const std::stop_token& stop);

    private:
        Connection& connection_;
        Clock::time_point unavailable_since_{};
        bool refused_ = false;  // the server has refused a connection because of its limit, since unavailable_since_
    };

    /// Throws: what check_socket_trust() throws, if the token goes to a Unix socket.
    void check_socket() const;
    void met() { met_ = true; }
    [[noreturn]] void throw_unavailable(const grpc::Status& status, bool refused) const;

    std::string server_;
    std::string token_;
    std::string guarded_socket_,
        server_user_;  // path of the Unix socket that the token goes to; empty for other addresses
    std::chrono::milliseconds connect_timeout_, reconnect_timeout_;
    std::shared_ptr<grpc::Channel> channel_;
    std::atomic<Clock::time_point> heard_ = Clock::time_point();
    std::atomic<bool> met_ = false;  // the server has been available at least once
    std::atomic<std::uint64_t> small_input_ = ~std::uint64_t(0);
};

}  // namespace octopair::service
