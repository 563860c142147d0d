// ConnectionWatch: which connections of a TCP listener are cut before a client has shown who it is, and how many each client has.
//
// A connection is known after its first call that the server admits. Until then it may be anybody's, so it is bounded:
//   - in time: at most `greeting` from its start;
//   - in bytes received: at most `max_bytes`. An endless header, for example, would cost the server much time (CVE-2023-33953). So the
//     first call of a connection must be small; Describe is;
//   - in refused calls: at most `max_refused_calls`. Calls that are reset at once, for example, would cost much (CVE-2023-44487);
//   - in number: all unknown connections together may take half of the slots, those of one address an eighth. Beyond that, the
//     oldest unknown connection of the address that has most of them is cut. So known clients always find slots.
// A known connection counts for the client of its first call, until it is closed. It is bounded in calls that it resets (CVE-2023-44487):
//   - `max_open_calls`: calls that have begun and not ended. HTTP/2 permits fewer streams; the others were reset, and the server has not
//     dealt with that yet;
//   - `max_resets`: calls of a client that ended by a reset lately. A connection with at most
//     `tolerated_resets` of them is not cut for those of others.
// After such a cut the client's new connections are cut at their first call, for a `pause`.
//
// After a connection was cut for its bytes or calls, new connections of its address wait. They are handed on one by one, with an
// interval between them. Otherwise a stranger could connect again at once and cost as much time again. No address is refused, because
// clients may share it.
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
    double max_resets = 256, resets_per_second = 50;  ///< at once, and then
    double tolerated_resets = 16;                     ///< of a connection
    std::chrono::milliseconds pause{1000};
    std::chrono::milliseconds interval{50};        ///< between waiting connections of one address
    std::chrono::milliseconds remembered{10'000};  ///< after a cut: time in which new connections wait
};

/// Thread safety: none; the caller locks.
class ConnectionWatch {
public:
    using Clock = std::chrono::steady_clock;

    explicit ConnectionWatch(const ConnectionLimits& limits) : limits_(limits) {}

    /// The other end of a connection.
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
        std::uint64_t connection;  ///< its number in note_begin()
    };
    /// Notes that `client` makes a call on the connection of a peer. A connection that is not known yet becomes known and is not watched
    /// any longer, unless the client has too many already. If the client pauses, the connection is cut.
    Admission make_known(const std::string& name, const Client& client, Clock::time_point now);
    /// Notes that a call begins on the connection with this number. Numbers are not used again. Returns false to refuse the call.
    bool note_begin(std::uint64_t number, Clock::time_point now);
    /// Notes that a call ends. `reset`: the client has ended it.
    void note_end(std::uint64_t number, bool reset, Clock::time_point now);
    /// Notes that a call of a peer was refused, because the server does not know who makes it.
    void note_refused(const std::string& name, Clock::time_point now);
    /// Cuts the connections whose time or bytes are used up. Returns the number of connections cut since the last call.
    std::uint64_t check(Clock::time_point now);

    std::size_t unknown() const { return unknown_.size(); }  ///< number of connections that are not known yet
    std::size_t waiting() const;                             ///< number of those that wait

private:
    struct Unknown {
        Descriptor connection;  // after handing on, a copy: its number cannot be reused for another connection
        int number = -1;        // the descriptor that was handed on; -1: the connection waits
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
        int descriptor;  // gRPC's
        ino_t socket;    // shows whether the descriptor is still of this connection
        std::string client;

        bool is_open() const;
    };

    /// Number of recent events, which shrinks with time.
    struct Recent {
        double count = 0;
        Clock::time_point since;
    };

    /// The calls of a connection. gRPC ends some calls without telling, for example those with a message that is too large. So open calls
    /// are forgotten with time, as resets are, but more slowly.
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
    std::size_t forget_from_ = 64;  // number of entries from which on it is called
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
