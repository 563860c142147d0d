#include "service/server/net/connection_watch.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <utility>

namespace octopair::service {

namespace {

struct Received {
    bool open = false;
    std::uint64_t bytes = 0;  ///< bytes received so far; 0 if the system does not report them
};

/// Reads TCP_INFO. Its bytes are at a fixed place of the system's interface (linux/tcp.h), which glibc's struct tcp_info lacks.
Received received_by(int connection) {
    constexpr std::size_t bytes_at = 128;
    std::array<std::uint8_t, 256> info{};
    socklen_t size = info.size();
    if (::getsockopt(connection, IPPROTO_TCP, TCP_INFO, info.data(), &size) != 0) return {};
    Received received{info[0] == TCP_ESTABLISHED};
    if (size >= bytes_at + sizeof(received.bytes))
        std::memcpy(&received.bytes, &info[bytes_at], sizeof(received.bytes));
    return received;
}

/// Ends a connection, and drops the bytes that have arrived on it. After shutdown() gRPC would still read them: megabytes, with
/// thousands of calls.
void reset(int connection) {
    sockaddr none{};
    none.sa_family = AF_UNSPEC;
    if (::connect(connection, &none, sizeof(none)) != 0) (void)::shutdown(connection, SHUT_RDWR);
}

}  // namespace

void ConnectionWatch::add(Descriptor connection, const Peer& peer, Clock::time_point now) {
    while (is_full(peer.address)) cut_oldest();
    unknown_.push_back({std::move(connection), -1, peer, now});
}

std::vector<Descriptor> ConnectionWatch::take_ready(Clock::time_point now) {
    std::vector<Descriptor> ready;
    for (Unknown& connection : unknown_) {
        if (connection.number >= 0 || must_wait(connection.peer.address, now)) continue;
        connection.number = connection.connection.number();
        connection.since = now;
        Descriptor copy(::fcntl(connection.number, F_DUPFD_CLOEXEC, 0));
        ready.push_back(std::exchange(connection.connection, std::move(copy)));
    }
    // A connection whose descriptor cannot be copied (too many open files) is not watched. The limit on connections still holds.
    std::erase_if(unknown_, [](const Unknown& connection) { return !connection.connection.open(); });
    return ready;
}

std::size_t ConnectionWatch::waiting() const {
    return std::size_t(
        std::count_if(unknown_.begin(), unknown_.end(), [](const Unknown& one) { return one.number < 0; }));
}

/// Returns whether a connection of the address must wait. If false, the caller hands the connection on now. On a paced address, the next
/// connection must then wait for an interval.
bool ConnectionWatch::must_wait(const std::string& address, Clock::time_point now) {
    const auto found = paced_.find(address);
    if (found == paced_.end()) return false;
    if (now < found->second.next) return true;
    found->second.next = now + limits_.interval;
    return false;
}

bool ConnectionWatch::is_full(const std::string& address) const {
    const std::uint64_t most = limits_.max_connections;
    if (most == 0 || unknown_.empty()) return false;
    const auto same = std::uint64_t(std::count_if(unknown_.begin(), unknown_.end(), [&](const Unknown& connection) {
        return connection.peer.address == address;
    }));
    constexpr std::uint64_t at_least = 4;  // also under small limits, a few clients may connect at the same time
    return unknown_.size() >= std::max(at_least, most / 2) || same >= std::max(at_least, most / 8);
}

/// Cuts the oldest connection of the address that has the most unknown ones.
void ConnectionWatch::cut_oldest() {
    std::map<std::string, std::size_t> counts;
    for (const Unknown& connection : unknown_) ++counts[connection.peer.address];
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    cut(std::find_if(unknown_.begin(), unknown_.end(),
                     [&](const Unknown& connection) { return connection.peer.address == most->first; }));
}

void ConnectionWatch::cut(std::vector<Unknown>::iterator connection) {
    reset(connection->connection.number());
    unknown_.erase(connection);
    ++cut_;
}

void ConnectionWatch::cut_and_pace(std::vector<Unknown>::iterator connection, Clock::time_point now) {
    pace(connection->peer.address, now);
    cut(connection);
}

void ConnectionWatch::pace(const std::string& address, Clock::time_point now) {
    Paced& paced = paced_[address];
    paced.next = std::max(paced.next, now + limits_.interval);
    paced.until = now + limits_.remembered;
}

ConnectionWatch::Admission ConnectionWatch::make_known(const std::string& name, const Client& client,
                                                       Clock::time_point now) {
    const auto found = std::find_if(unknown_.begin(), unknown_.end(),
                                    [&](const Unknown& connection) { return connection.peer.name == name; });
    if (found == unknown_.end()) return Admission::known_before;
    if (const auto paused = paused_.find(client.name); paused != paused_.end() && now < paused->second) {
        cut_and_pace(found, now);
        return Admission::paused;
    }
    if (limits_.max_per_client > 0 && open_connections(client.name, now) >= limits_.max_per_client)
        return Admission::too_many;
    known_[client.connection] = {found->peer.address, found->number, socket_of(found->connection.number()),
                                 client.name};
    unknown_.erase(found);
    return Admission::known_now;
}

void ConnectionWatch::note_refused(const std::string& name, Clock::time_point now) {
    const auto found = std::find_if(unknown_.begin(), unknown_.end(),
                                    [&](const Unknown& connection) { return connection.peer.name == name; });
    if (found != unknown_.end() && ++found->refused_calls > limits_.max_refused_calls) cut_and_pace(found, now);
}

std::uint64_t ConnectionWatch::open_connections(const std::string& client, Clock::time_point now) {
    forget_closed(now);
    return std::uint64_t(
        std::count_if(known_.begin(), known_.end(), [&](const auto& known) { return known.second.client == client; }));
}

bool ConnectionWatch::Known::is_open() const { return socket_of(descriptor) == socket; }

void ConnectionWatch::forget_closed(Clock::time_point now) {
    std::erase_if(known_, [](const auto& known) { return !known.second.is_open(); });
    std::erase_if(calls_, [&](const auto& calls) {
        return now - calls.second.open.since > limits_.remembered && !known_.contains(calls.first);
    });
    constexpr std::size_t least = 64;
    forget_from_ = std::max(least, 2 * calls_.size());
}

bool ConnectionWatch::note_begin(std::uint64_t number, Clock::time_point now) {
    if (calls_.size() >= forget_from_) forget_closed(now);
    Recent& open = calls_[number].open;
    add(open, limits_.forgotten_per_second, now);
    if (open.count <= limits_.max_open_calls) return true;
    open.count = limits_.max_open_calls;
    cut_known(number, now);
    return false;
}

void ConnectionWatch::note_end(std::uint64_t number, bool reset, Clock::time_point now) {
    const auto found = calls_.find(number);
    if (found == calls_.end()) return;
    found->second.open.count = std::max(0.0, found->second.open.count - 1);
    if (!reset) return;
    const auto known = known_.find(number);
    // A connection that ends resets all its calls. Do not count these resets against the client.
    if (known == known_.end() || !known->second.is_open() || !received_by(known->second.descriptor).open) return;
    Recent& of_client = resets_[known->second.client];
    add(of_client, limits_.resets_per_second, now);
    add(found->second.resets, limits_.resets_per_second, now);
    of_client.count = std::min(of_client.count, limits_.max_resets + 1);
    if (of_client.count > limits_.max_resets && found->second.resets.count > limits_.tolerated_resets)
        cut_known(number, now);
}

void ConnectionWatch::add(Recent& recent, double per_second, Clock::time_point now) {
    const double seconds = std::chrono::duration<double>(now - recent.since).count();
    recent = {std::max(0.0, recent.count - seconds * per_second) + 1, now};
}

void ConnectionWatch::cut_known(std::uint64_t number, Clock::time_point now) {
    const auto found = known_.find(number);
    if (found == known_.end()) return;
    // gRPC may close the connection at any time, and the system may reuse its descriptor. Only a copy surely stays on this connection.
    const Descriptor copy(::fcntl(found->second.descriptor, F_DUPFD_CLOEXEC, 0));
    if (copy.open() && socket_of(copy.number()) == found->second.socket) {
        reset(copy.number());
        pace(found->second.address, now);
        paused_[found->second.client] = now + limits_.pause;
        ++cut_;
    }
    known_.erase(found);
}

std::uint64_t ConnectionWatch::check(Clock::time_point now) {
    for (std::size_t i = unknown_.size(); i-- > 0;) {
        const auto connection = unknown_.begin() + std::ptrdiff_t(i);
        const Received received = received_by(connection->connection.number());
        if (!received.open) {
            unknown_.erase(connection);
        } else if (connection->number >= 0 && received.bytes > limits_.max_bytes) {
            cut_and_pace(connection, now);
        } else if (now - connection->since > limits_.greeting) {
            cut(connection);
        }
    }
    std::erase_if(resets_, [&](const auto& resets) { return now > resets.second.since + limits_.remembered; });
    std::erase_if(paused_, [&](const auto& paused) { return now > paused.second + limits_.remembered; });
    std::erase_if(paced_, [&](const auto& paced) { return now > paced.second.until; });
    return std::exchange(cut_, 0);
}

ino_t socket_of(int descriptor) {
    struct stat found {};
    return ::fstat(descriptor, &found) == 0 && S_ISSOCK(found.st_mode) ? found.st_ino : 0;
}

std::optional<ConnectionWatch::Peer> peer_of(const Descriptor& connection) {
    sockaddr_storage peer{};
    socklen_t size = sizeof(peer);
    if (::getpeername(connection.number(), reinterpret_cast<sockaddr*>(&peer), &size) != 0) return std::nullopt;
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (peer.ss_family == AF_INET) {
        const auto& four = reinterpret_cast<const sockaddr_in&>(peer);
        if (::inet_ntop(AF_INET, &four.sin_addr, text.data(), text.size()) == nullptr) return std::nullopt;
        return ConnectionWatch::Peer{"ipv4:" + std::string(text.data()) + ":" + std::to_string(ntohs(four.sin_port)),
                                     text.data()};
    }
    if (peer.ss_family != AF_INET6) return std::nullopt;
    const auto& six = reinterpret_cast<const sockaddr_in6&>(peer);
    if (IN6_IS_ADDR_V4MAPPED(&six.sin6_addr)) {
        if (::inet_ntop(AF_INET, &six.sin6_addr.s6_addr[12], text.data(), text.size()) == nullptr) return std::nullopt;
        return ConnectionWatch::Peer{"ipv4:" + std::string(text.data()) + ":" + std::to_string(ntohs(six.sin6_port)),
                                     text.data()};
    }
    if (::inet_ntop(AF_INET6, &six.sin6_addr, text.data(), text.size()) == nullptr) return std::nullopt;
    // One client may use all addresses of a network with a prefix of 64 bits.
    in6_addr network = six.sin6_addr;
    std::fill(std::begin(network.s6_addr) + 8, std::end(network.s6_addr), std::uint8_t(0));
    std::array<char, INET6_ADDRSTRLEN> prefix{};
    (void)::inet_ntop(AF_INET6, &network, prefix.data(), prefix.size());
    return ConnectionWatch::Peer{"ipv6:%5B" + std::string(text.data()) + "%5D:" + std::to_string(ntohs(six.sin6_port)),
                                 prefix.data()};
}

}  // namespace octopair::service
