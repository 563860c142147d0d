// Listener: the listening socket of a server, with a limit on connections.
//
// The listener accepts connections and hands them to gRPC. gRPC's own listener would replace the Unix socket of a running
// server, and cannot limit the number of connections.
#pragma once

#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/descriptor.hpp"
#include "service/protocol/address.hpp"
#include "service/server/net/connection_watch.hpp"

namespace octopair::service {

struct ListenerOptions {
    std::uint64_t max_connections = 0;       ///< 0: no limit
    std::uint64_t max_per_client = 0;        ///< over TCP; 0: no limit
    bool encrypted = false;                  ///< connections use TLS; a refused connection then gets no reason
    std::function<void(Descriptor)> accept;  ///< receives each accepted connection
    std::function<void()> refused;           ///< called after refusals and cuts, at most once a second
    /// Receives the process at the other end of each accepted connection of a Unix socket, for the log.
    std::function<void(const std::string&)> connected;
    std::chrono::milliseconds greeting{10'000};  ///< time in which a TCP client must make a call that is admitted
};

class Listener {
public:
    /// Binds to `address`. Only the owner of a Unix socket may connect. A lock file beside the socket shows whether its server still runs;
    /// the socket of a dead server is replaced.
    /// `passed`: a listening socket to use instead of `address`, or null. The program that made the socket keeps a copy. So the destructor
    /// does not remove the socket, and clients that connect between two servers wait.
    /// `unprotected`: result of missing_protection().
    /// Throws: Error{usage} with `unprotected`, unless empty, for an address that is not loopback; Error{io_failed} if binding
    /// fails.
    Listener(const Address& address, const std::shared_ptr<Descriptor>& passed, const std::string& unprotected);
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    /// Stops accepting. Removes the Unix socket, unless another server has replaced the socket.
    ~Listener();

    /// Returns the address, with the port that the system chose if port 0 was given.
    const Address& address() const { return address_; }

    /// Starts a thread that accepts connections. The functions of `options` are called on this thread.
    void start(ListenerOptions options);
    /// Stops accepting connections.
    void stop();
    /// Calls ConnectionWatch::make_known(). Thread safety: any thread may call it.
    ConnectionWatch::Admission make_known(const std::string& peer, const ConnectionWatch::Client& client);
    /// Call ConnectionWatch::note_begin() and note_end(). Thread safety: any thread may call them.
    bool note_begin(std::uint64_t number);
    void note_end(std::uint64_t number, bool reset);
    /// Calls ConnectionWatch::note_refused(). Thread safety: any thread may call it.
    void note_refused(const std::string& peer);
    /// Returns whether there are connections without an admitted call. Thread safety: any thread may call it.
    bool awaits_calls() const { return unknown_ > 0; }
    std::uint64_t connections() const { return connections_; }
    /// Returns the number of connections that were refused or cut.
    std::uint64_t refused() const { return refused_; }

private:
    /// A connection that was handed to gRPC. The inode is kept because the system reuses numbers of closed descriptors.
    struct Accepted {
        int number;
        ino_t socket;
    };

    /// A connection beyond the limit. The listener sends the reason after a delay: otherwise the client's gRPC would reconnect thousands of
    /// times a second. The listener closes the connection after another delay, so that the client can read the reason first.
    struct Refused {
        Descriptor connection;
        std::string why;
        std::chrono::steady_clock::time_point since;
        bool reason_sent = false;
    };

    void bind_unix();
    void bind_tcp(const std::string& unprotected);
    void take_over(Descriptor passed, const std::string& unprotected);
    void accept_connections();
    void take(Descriptor connection);
    bool is_ours(const Descriptor& connection) const;
    void report_process(const Descriptor& connection) const;
    void forget_closed();
    void refuse_one_more();
    void refill_spares();
    void refuse(Descriptor connection, std::string why);
    void watch(Descriptor connection);
    void hand_on_ready();
    void hand_on(Descriptor connection);
    void check_watched();
    void report_refusals();
    void send_refusal(Refused& refused) const;
    void close_refused();

    Address address_;
    ListenerOptions options_;
    Descriptor lock_, socket_, wake_;
    ino_t bound_ = 0;                 // inode of the Unix socket that this listener made
    std::vector<Descriptor> spares_;  // reserve: closing one frees a descriptor to accept and refuse a connection
    std::vector<Accepted> accepted_;
    std::deque<Refused> refused_connections_;
    std::chrono::steady_clock::time_point last_report_;  // last call of options_.refused
    std::size_t forget_from_ = 64;
    std::size_t waiting_ = 0;  // connections that are not handed to gRPC yet (ConnectionWatch)
    std::mutex watch_mutex_;
    std::optional<ConnectionWatch>
        watch_;  // guarded by watch_mutex_; not for Unix sockets, whose peers are this user or root
    std::atomic<std::uint64_t> connections_ = 0, refused_ = 0, unknown_ = 0;
    std::thread thread_;
};

}  // namespace octopair::service
