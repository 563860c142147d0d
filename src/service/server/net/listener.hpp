// Listener: the socket of a server, and who may connect to it.
//
// We accept connections ourselves and hand them to gRPC: it would take the place of a live server's Unix socket, and
// knows no bound on connections.
#pragma once

#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "base/descriptor.hpp"
#include "service/protocol/address.hpp"

namespace octopair::service {

class Listener {
public:
    /// Binds. A Unix socket is made for its owner alone; one that a dead server left is replaced, beside it lies a lock.
    /// `unprotected`: what a server lacks that others than this machine may reach, in words; empty: nothing. Throws
    /// Error{usage} with them for an address that is not loopback, Error{io_failed} if it is taken or cannot be had.
    Listener(const Address& address, const std::string& unprotected);
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    /// Takes a Unix socket away.
    ~Listener();

    /// With the port that the system chose, if 0 was asked for.
    const Address& address() const { return address_; }

    struct Terms {
        std::uint64_t most_connections = 0;  ///< 0: no limit
        bool encrypted = false;              ///< then a refusal cannot say why
        std::function<void(Descriptor)> accept;
        std::function<void()> refused;  ///< not told of each one in a flood
    };
    /// From now on connections are accepted, on a thread of its own; the functions of `terms` are called there.
    void start(Terms terms);
    /// No more.
    void stop();
    std::uint64_t connections() const { return connections_; }
    std::uint64_t refused() const { return refused_; }

private:
    /// A connection that was handed over: a descriptor's number may be another one's since.
    struct Known {
        int number;
        ino_t socket;
    };

    /// One too many. It is told why a little later, or gRPC would connect again at once, thousands of times a
    /// second; and closed later still, or its own words would find nobody, and it would not read ours.
    struct Refused {
        Descriptor connection;
        std::string why;
        std::chrono::steady_clock::time_point since;
        bool told = false;
    };

    void bind_unix();
    void bind_tcp(const std::string& unprotected);
    void take_connections();
    void take(Descriptor connection);
    bool is_ours(const Descriptor& connection) const;
    void forget_closed();
    void refuse_one_more();
    void take_spares();
    void refuse(Descriptor connection, std::string why);
    void see_out(Refused& refused) const;
    void see_out_refused();

    Address address_;
    Terms terms_;
    Descriptor lock_, socket_, wake_;
    std::vector<Descriptor> spares_;  // given up, one at a time, to tell others that there are no more
    std::vector<Known> known_;
    std::deque<Refused> leaving_;
    std::chrono::steady_clock::time_point told_;  // of a refusal
    std::size_t forget_from_ = 64;
    std::atomic<std::uint64_t> connections_ = 0, refused_ = 0;
    std::thread thread_;
};

}  // namespace octopair::service
