// ConnectionWatch: limits on the connections of a TCP listener. It cuts connections whose client is not known yet, and counts the
// connections and resets of known clients.
//
// A connection becomes known when the server admits its first call. An unknown connection may be of an attacker, so it is limited:
//   - in time: at most `greeting` from its start;
//   - in bytes received: at most `max_bytes`. An endless header, for example, would cost the server much time (CVE-2023-33953). So the
//     first call of a connection must be small; Describe is;
//   - in refused calls: at most `max_refused_calls`. Calls that are reset at once, for example, would cost much (CVE-2023-44487);
//   - in number: all unknown connections together may take half of the slots, and the unknown connections of one address an eighth.
//     Beyond these limits, the watch cuts the oldest unknown connection of the address with the most unknown connections. So known
//     clients always find slots.
// A known connection counts for the client of its first call, until it is closed. Its calls are limited (CVE-2023-44487):
//   - `max_open_calls`: calls that have begun and not ended. HTTP/2 permits fewer streams; the others were reset, and the server has not
//     dealt with that yet;
//   - `max_resets`: calls of a client that recently ended by a reset, on all its connections together. A connection with at most
//     `tolerated_resets` resets is not cut for the resets of other connections.
// After such a cut, the server cuts new connections of this client at their first call, for the time `pause`.
//
// After a connection was cut for its bytes or calls, new connections of its address wait, and gRPC gets only one per `interval`.
// Otherwise an attacker could connect again at once and cost the same time again. No address is refused, because honest clients may
// share the address with the attacker.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/descriptor.hpp"

namespace octopair::service {

struct ConnectionLimits {
    std::uint64_t max_connections = 0;  ///< 0: no limit on the number of unknown connections
    std::uint64_t max_per_client = 0;   ///< known connections of one client; 0: no limit
    std::chrono::milliseconds greeting{10'000};
    std::uint64_t max_bytes = 128 << 10;
    std::uint64_t max_refused_calls = 32;
    double max_open_calls = 512, forgotten_per_second = 5;
    double max_resets = 256, resets_per_second = 50;  ///< of a client: resets at once, and allowed rate afterwards
    double tolerated_resets = 16;                     ///< recent resets for which a connection is never cut
    std::chrono::milliseconds pause{1000};
    std::chrono::milliseconds interval{50};        ///< between handing on two waiting connections of one address
    std::chrono::milliseconds remembered{10'000};  ///< how long, after a cut, new connections of the address wait
};

/// Thread safety: none; the caller locks.
class ConnectionWatch {
public:
    using Clock = std::chrono::steady_clock;

    explicit ConnectionWatch(const ConnectionLimits& limits) : limits_(limits) {}

    /// The client's end of a connection.
    struct Peer {
        std::string name;  ///< as gRPC writes it, for example "ipv4:192.0.2.1:4711"
        std::string
            address;  ///< part that a client cannot choose freely: 192.0.2.1, or the first 64 bits of an IPv6 address
    };
    /// Watches a connection until it is known, closed or cut. Cuts other connections if too many are unknown.
    void add(Descriptor connection, const Peer& peer, Clock::time_point now);
    /// Returns the connections that need not wait any longer, in the order of add(). Keeps copies of their descriptors.
    std::vector<Descriptor> take_ready(Clock::time_point now);
    enum class Admission : std::uint8_t { known_before, known_now, too_many, paused };
    struct Client {
        std::string name;
        std::uint64_t connection;  ///< number of the connection in note_begin()
    };
    /// Records that `client` makes an admitted call on the connection of the peer `name`. An unknown connection becomes known, unless the
    /// client has max_per_client known connections (too_many). During the client's pause the connection is cut (paused).
    Admission make_known(const std::string& name, const Client& client, Clock::time_point now);
    /// Records that a call begins on a connection. Returns false if the call must be refused. `number`: unique number of the connection.
    bool note_begin(std::uint64_t number, Clock::time_point now);
    /// Records that a call ends. `reset`: the client has reset the call.
    void note_end(std::uint64_t number, bool reset, Clock::time_point now);
    /// Records that a call of a peer was refused because the caller is not authenticated.
    void note_refused(const std::string& name, Clock::time_point now);
    /// Cuts the connections whose time or bytes are used up. Returns the number of connections cut since the last call.
    std::uint64_t check(Clock::time_point now);

    std::size_t unknown() const { return unknown_.size(); }  ///< number of connections that are not known yet
    std::size_t waiting() const;  ///< number of unknown connections that wait for take_ready()

private:
    struct Unknown {
        Descriptor connection;  // after handing on, a copy: its number cannot be reused for another connection
        int number = -1;        // number of the descriptor that was handed on; -1: the connection waits
        Peer peer;
        Clock::time_point since;  // begin of waiting, or time of handing on
        std::uint64_t refused_calls = 0;
    };

    /// An address whose connection was cut for its bytes or calls.
    struct Paced {
        Clock::time_point next;   // earliest time to hand on the next connection
        Clock::time_point until;  // until then new connections wait
    };

    struct Known {
        std::string address;
        int descriptor;  // gRPC owns the descriptor
        ino_t socket;    // inode; if the descriptor has another inode, gRPC has closed this connection
        std::string client;

        bool is_open() const;
    };

    /// Leaky counter of recent events: the count decreases with time (add()).
    struct Recent {
        double count = 0;
        Clock::time_point since;
    };

    /// Counters of a connection's calls. For some calls, such as calls with a message that is too large, gRPC reports no end. So the count
    /// of open calls decreases with time, too, but more slowly than the count of resets.
    struct Calls {
        Recent open, resets;
    };

    bool is_full(const std::string& address) const;
    std::uint64_t open_connections(const std::string& client, Clock::time_point now);
    void cut_oldest();
    void cut(std::vector<Unknown>::iterator connection);
    void cut_and_pace(std::vector<Unknown>::iterator connection, Clock::time_point now);
    void cut_known(std::uint64_t number, Clock::time_point now);
    void pace(const std::string& address, Clock::time_point now);
    static void add(Recent& recent, double per_second, Clock::time_point now);
    void forget_closed(Clock::time_point now);
    bool must_wait(const std::string& address, Clock::time_point now);

    const ConnectionLimits limits_;
    std::vector<Unknown> unknown_;  // oldest first
    // By number. Entries of closed connections are removed by forget_closed().
    std::unordered_map<std::uint64_t, Known> known_;
    std::unordered_map<std::uint64_t, Calls> calls_;
    std::size_t forget_from_ = 64;  // size of calls_ at which note_begin() calls forget_closed()
    // Entries are removed after `remembered`.
    std::map<std::string, Recent> resets_;             // by client
    std::map<std::string, Clock::time_point> paused_;  // by client: until when
    std::map<std::string, Paced> paced_;               // by address
    std::uint64_t cut_ = 0;
};

/// Returns the inode of a socket, or 0 if the descriptor is not of a socket. The system reuses numbers of closed descriptors, but not
/// inodes of open sockets.
ino_t socket_of(int descriptor);

/// Returns the peer of a TCP connection, or nothing if the connection has ended.
std::optional<ConnectionWatch::Peer> peer_of(const Descriptor& connection);

}  // namespace octopair::service
