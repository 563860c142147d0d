// ConnectionWatch: which connections of a TCP listener are cut before a client has shown who it is.
//
// A connection is known after its first call that the server admits. Until then it may be anybody's, so it is bounded:
//   - in time: at most `greeting` from its start;
//   - in bytes received: at most `max_bytes`. An endless header, for example, would cost the server much time (CVE-2023-33953). So the
//     first call of a connection must be small; Describe is;
//   - in number: all unknown connections together may take half of the slots, those of one address an eighth. Beyond that, the
//     oldest unknown connection of the address that has most of them is cut. So known clients always find slots.
#pragma once

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
        std::chrono::milliseconds greeting{10'000};
        std::uint64_t max_bytes = 512 << 10;
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
    /// Stops watching the connection of a peer.
    void make_known(const std::string& name);
    /// Cuts the connections whose time or bytes are used up. Returns the number of connections cut since the last call.
    std::uint64_t check(Clock::time_point now);

    std::size_t unknown() const { return unknown_.size(); }

private:
    struct Unknown {
        Descriptor connection;  // a copy: its number cannot be reused for another connection
        Peer peer;
        Clock::time_point since;
    };

    bool is_full(const std::string& address) const;
    void cut_oldest();
    void cut(std::vector<Unknown>::iterator connection);

    const Terms terms_;
    std::vector<Unknown> unknown_;  // oldest first
    std::uint64_t cut_ = 0;
};

/// Returns the peer of a TCP connection, or nothing if the connection has ended.
std::optional<ConnectionWatch::Peer> peer_of(const Descriptor& connection);

}  // namespace octopair::service
