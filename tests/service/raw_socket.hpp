// A socket that sends what it likes, and HTTP/2 (RFC 9113) by hand.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "base/descriptor.hpp"

namespace octopair::test {

/// Connected to `unix:PATH` or `127.0.0.1:PORT`.
class RawSocket {
public:
    /// Throws std::runtime_error if it cannot be connected.
    explicit RawSocket(const std::string& address);

    int number() const { return socket_.number(); }
    /// False if the other side is gone, or takes nothing for five seconds.
    bool send(std::string_view bytes) const;
    /// What comes until the other side closes, or for so long.
    std::string receive(std::chrono::milliseconds most);
    /// Whether the other side has closed, within so long; what it sent is dropped.
    bool is_closed_within(std::chrono::milliseconds most);

private:
    Descriptor socket_;
    bool closed_ = false;
};

inline constexpr std::string_view http2_preface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

struct Http2Frame {
    char type = 0;
    char flags = 0;
    std::uint32_t stream = 0;
};
inline constexpr char data_frame = 0, headers_frame = 1, reset_frame = 3, settings_frame = 4, ping_frame = 6;

std::string http2_frame(const Http2Frame& frame, std::string_view payload);
/// The head of a gRPC call of a method of octopair's service.
std::string grpc_head(std::uint32_t stream, const std::string& method);
/// A gRPC message's first five bytes.
std::string grpc_prefix(std::uint32_t length);

}  // namespace octopair::test
