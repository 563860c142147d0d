// ConnectionWatch: which connections of a TCP listener are cut before a client has shown who it is, and how many each client has.
//
// A connection is known after its first call that the server admits. Until then it may be anybody's, so it is bounded:
//   - in time: at most `greeting` from its start;
//   - in bytes received: at most `max_bytes`. An endless header, for example, would cost the server much time (CVE-2023-33953). So the
//     first call of a connection must be small; Describe is;
//   - in refused calls: at most `max_refused_calls`. Calls that are reset at once, for example, would cost much (CVE-2023-44487);
//   - in number: all unknown connections together may take half of the slots, those of one address an eighth. Beyond that, the
//     oldest unknown connection of the address that has most of them is cut. So known clients always find slots.
// A known connection counts for the client of its first call, until it is closed.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/descriptor.hpp"

namespace octopair::service {

/// Thread safety: none; the caller locks.
class ConnectionWatch {
public:
    using Clock = std::chrono::steady_clock;

    struct Terms {
        std::uint64_t max_connections = 0;  ///< 0: no limit on the number of unknown connections
        std::uint64_t max_per_client = 0;   ///< known connections of one client; 0: no limit
        std::chrono::milliseconds greeting{10'000};
        std::uint64_t max_bytes = 128 << 10;
        std::uint64_t max_refused_calls = 32;
    };
    explicit ConnectionWatch(const Terms& terms) : terms_(terms) {}

    /// The other end of a connection.
    struct Peer {
        std::string name;  ///< as gRPC writes it, for example "ipv4:192.0.2.1:4711"
        std::string
            address;  ///< part that a client cannot choose freely: 192.0.2.1, or the first 64 bits of an IPv6 address
    };
    /// Watches a connection until it is known, closed or cut. Keeps a copy of its descriptor until then. Cuts other connections if too many
    /// are unknown.
    void add(const Descriptor& connection, const Peer& peer, Clock::time_point now);
    enum class Admission : std::uint8_t { known_before, known_now, too_many };
    /// Notes that `client` makes a call on the connection of a peer. A connection that is not known yet becomes known and is not watched
    /// any longer, unless the client has too many already.
    Admission make_known(const std::string& name, const std::string& client);
    /// Notes that a call of a peer was refused, because the server does not know who makes it.
    void note_refused(const std::string& name);
    /// Cuts the connections whose time or bytes are used up. Returns the number of connections cut since the last call.
    std::uint64_t check(Clock::time_point now);

    std::size_t unknown() const { return unknown_.size(); }

private:
    struct Unknown {
        Descriptor connection;  // a copy: its number cannot be reused for another connection
        int number;             // gRPC's descriptor
        Peer peer;
        Clock::time_point since;
        std::uint64_t refused_calls = 0;
    };

    struct Known {
        int number;    // gRPC's descriptor
        ino_t socket;  // shows whether the descriptor is still of this connection
        std::string client;
    };

    bool is_full(const std::string& address) const;
    std::uint64_t open_connections(const std::string& client);
    void cut_oldest();
    void cut(std::vector<Unknown>::iterator connection);

    const Terms terms_;
    std::vector<Unknown> unknown_;  // oldest first
    std::vector<Known> known_;      // closed ones are removed when open ones are counted
    std::uint64_t cut_ = 0;
};

/// Returns the inode of a socket, or 0 if the descriptor is not of a socket. The system reuses numbers of closed descriptors, but not
/// inodes of open sockets.
ino_t socket_of(int descriptor);

/// Returns the peer of a TCP connection, or nothing if the connection has ended.
std::optional<ConnectionWatch::Peer> peer_of(const Descriptor& connection);

}  // namespace octopair::service
