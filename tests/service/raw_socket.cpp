#include "service/raw_socket.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "service/protocol/address.hpp"

namespace octopair::test {

namespace {

using Clock = std::chrono::steady_clock;

Descriptor connected(const service::Address& address) {
    Descriptor socket(::socket(address.is_unix() ? AF_UNIX : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    int failed = -1;
    if (address.is_unix()) {
        sockaddr_un name{};
        name.sun_family = AF_UNIX;
        std::memcpy(name.sun_path, address.path.c_str(), address.path.size() + 1);
        failed = ::connect(socket.number(), reinterpret_cast<const sockaddr*>(&name), sizeof name);
    } else {
        sockaddr_in name{};
        name.sin_family = AF_INET;
        name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        name.sin_port = htons(std::uint16_t(std::stoul(address.port)));
        failed = ::connect(socket.number(), reinterpret_cast<const sockaddr*>(&name), sizeof name);
    }
    if (failed != 0) throw std::runtime_error(std::string("cannot connect: ") + std::strerror(errno));
    return socket;
}

bool is_ready(int socket, short events, Clock::time_point until) {
    pollfd watched = {socket, events, 0};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
    return ::poll(&watched, 1, int(std::max<long long>(0, left.count()))) > 0;
}

std::string big_endian(std::uint32_t number, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) text += char(number >> (8 * i));
    return text;
}

/// Encodes a header as a literal without table entries (RFC 7541).
std::string header(const std::string& name, const std::string& value) {
    return std::string(1, '\0') + char(name.size()) + name + char(value.size()) + value;
}

}  // namespace

RawSocket::RawSocket(const std::string& address) : socket_(connected(service::parse_address(address))) {}

bool RawSocket::send(std::string_view bytes) const {
    const auto until = Clock::now() + std::chrono::seconds(5);
    while (!bytes.empty()) {
        const ssize_t sent = ::send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent > 0) {
            bytes.remove_prefix(std::size_t(sent));
        } else if ((errno != EAGAIN && errno != EINTR) || !is_ready(socket_.number(), POLLOUT, until)) {
            return false;
        }
    }
    return true;
}

std::string RawSocket::receive(std::chrono::milliseconds most) {
    const auto until = Clock::now() + most;
    std::string all;
    std::array<char, 65536> part{};
    while (!closed_ && is_ready(socket_.number(), POLLIN, until)) {
        const ssize_t count = ::recv(socket_.number(), part.data(), part.size(), 0);
        closed_ = count <= 0;
        if (count > 0) all.append(part.data(), std::size_t(count));
    }
    return all;
}

bool RawSocket::is_closed_within(std::chrono::milliseconds most) {
    (void)receive(most);
    return closed_;
}

std::string http2_frame(const Http2Frame& frame, std::string_view payload) {
    return big_endian(std::uint32_t(payload.size()), 3) + frame.type + frame.flags + big_endian(frame.stream, 4) +
           std::string(payload);
}

std::string grpc_head(std::uint32_t stream, const std::string& method) {
    constexpr char end_headers = 4;
    return http2_frame({headers_frame, end_headers, stream},
                       header(":method", "POST") + header(":scheme", "http") +
                           header(":path", "/octopair.v1.Octopair/" + method) + header(":authority", "localhost") +
                           header("te", "trailers") + header("content-type", "application/grpc"));
}

std::string grpc_prefix(std::uint32_t length) { return std::string(1, '\0') + big_endian(length, 4); }

}  // namespace octopair::test
