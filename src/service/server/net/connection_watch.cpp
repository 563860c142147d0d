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
    std::uint64_t bytes = 0;  ///< 0 if the system does not tell
};

/// Reads TCP_INFO. Its bytes are at a fixed place of the system's interface (linux/tcp.h), which glibc's struct tcp_info lacks.
Received received_by(const Descriptor& connection) {
    constexpr std::size_t bytes_at = 128;
    std::array<std::uint8_t, 256> info{};
    socklen_t size = info.size();
    if (::getsockopt(connection.number(), IPPROTO_TCP, TCP_INFO, info.data(), &size) != 0) return {};
    Received received{info[0] == TCP_ESTABLISHED};
    if (size >= bytes_at + sizeof(received.bytes))
        std::memcpy(&received.bytes, &info[bytes_at], sizeof(received.bytes));
    return received;
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
    // Without descriptors for copies nothing can be watched; the limit on connections still holds.
    std::erase_if(unknown_, [](const Unknown& connection) { return !connection.connection.open(); });
    return ready;
}

std::size_t ConnectionWatch::waiting() const {
    return std::size_t(
        std::count_if(unknown_.begin(), unknown_.end(), [](const Unknown& one) { return one.number < 0; }));
}

/// Returns whether a connection of the address must wait. If not, it is handed on now.
bool ConnectionWatch::must_wait(const std::string& address, Clock::time_point now) {
    const auto found = paced_.find(address);
    if (found == paced_.end()) return false;
    if (now < found->second.next) return true;
    found->second.next = now + terms_.interval;
    return false;
}

bool ConnectionWatch::is_full(const std::string& address) const {
    const std::uint64_t most = terms_.max_connections;
    if (most == 0 || unknown_.empty()) return false;
    const auto same = std::uint64_t(std::count_if(unknown_.begin(), unknown_.end(), [&](const Unknown& connection) {
        return connection.peer.address == address;
    }));
    constexpr std::uint64_t few = 4;  // clients that connect at the same time
    return unknown_.size() >= std::max(few, most / 2) || same >= std::max(few, most / 8);
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
    (void)::shutdown(connection->connection.number(), SHUT_RDWR);
    unknown_.erase(connection);
    ++cut_;
}

void ConnectionWatch::cut_and_pace(std::vector<Unknown>::iterator connection, Clock::time_point now) {
    Paced& paced = paced_[connection->peer.address];
    paced.next = std::max(paced.next, now + terms_.interval);
    paced.until = now + terms_.remembered;
    cut(connection);
}

ConnectionWatch::Admission ConnectionWatch::make_known(const std::string& name, const std::string& client) {
    const auto found = std::find_if(unknown_.begin(), unknown_.end(),
                                    [&](const Unknown& connection) { return connection.peer.name == name; });
    if (found == unknown_.end()) return Admission::known_before;
    if (terms_.max_per_client > 0) {
        if (open_connections(client) >= terms_.max_per_client) return Admission::too_many;
        known_.push_back({found->number, socket_of(found->connection.number()), client});
    }
    unknown_.erase(found);
    return Admission::known_now;
}

void ConnectionWatch::note_refused(const std::string& name, Clock::time_point now) {
    const auto found = std::find_if(unknown_.begin(), unknown_.end(),
                                    [&](const Unknown& connection) { return connection.peer.name == name; });
    if (found != unknown_.end() && ++found->refused_calls > terms_.max_refused_calls) cut_and_pace(found, now);
}

std::uint64_t ConnectionWatch::open_connections(const std::string& client) {
    std::erase_if(known_, [](const Known& connection) { return socket_of(connection.number) != connection.socket; });
    return std::uint64_t(std::count_if(known_.begin(), known_.end(),
                                       [&](const Known& connection) { return connection.client == client; }));
}

std::uint64_t ConnectionWatch::check(Clock::time_point now) {
    for (std::size_t i = unknown_.size(); i-- > 0;) {
        const auto connection = unknown_.begin() + std::ptrdiff_t(i);
        const Received received = received_by(connection->connection);
        if (!received.open) {
            unknown_.erase(connection);
        } else if (connection->number >= 0 && received.bytes > terms_.max_bytes) {
            cut_and_pace(connection, now);
        } else if (now - connection->since > terms_.greeting) {
            cut(connection);
        }
    }
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
