// Connection: the way to a server, which may break and come back.
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

/// Thread-safe.
class Connection {
public:
    using Clock = std::chrono::steady_clock;

    /// Throws as octopair::connect, but does not connect yet.
    Connection(std::string_view address, const ClientOptions& options);

    const std::string& server() const { return server_; }
    /// For stubs, which cost little to make.
    const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }
    /// Every call's context goes through here.
    void prepare(grpc::ClientContext& context) const;
    /// Asks the server what it is, to find out whether there is one. Throws as persist.
    void check_server();

    /// Jobs with an input of at most so many bytes had results that fit into one message, as far as is known.
    std::atomic<std::uint64_t>& small_input() { return small_input_; }

    /// The server did something: it is not away.
    void heard() {
        heard_ = Clock::now();
        met_ = true;
    }

    /// Makes calls until one ends with another status than that the server is away, as long as the patience lasts,
    /// or, while it was never there, the time for connecting. `attempt` makes one, and returns its status. Throws what the last
    /// status says unless it is OK, Error{cancelled} on a stop.
    template <typename Attempt>
    void persist(const std::stop_token& stop, Attempt&& attempt) {
        for (Patience patience(*this);;) {
            const grpc::Status status = attempt();
            if (status.ok()) return met();
            patience.wait_or_throw(status, stop);
        }
    }

private:
    /// Of one call: how long the server has been away.
    class Patience {
    public:
        explicit Patience(Connection& connection) : connection_(connection) {}
        void wait_or_throw(const grpc::Status& status, const std::stop_token& stop);

    private:
        Connection& connection_;
        Clock::time_point away_since_{};
        bool refused_ = false;  // since then the server has said that it takes no more connections
    };

    void met() { met_ = true; }
    [[noreturn]] void give_up(const grpc::Status& status, bool refused) const;

    std::string server_;
    std::string token_;
    std::chrono::milliseconds connect_timeout_, patience_;
    std::shared_ptr<grpc::Channel> channel_;
    std::atomic<Clock::time_point> heard_ = Clock::time_point();
    std::atomic<bool> met_ = false;  // the server was there once
    std::atomic<std::uint64_t> small_input_ = ~std::uint64_t(0);
};

}  // namespace octopair::service
