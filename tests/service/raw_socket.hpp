// A socket that sends arbitrary bytes, and helpers that encode HTTP/2 (RFC 9113) by hand.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "base/descriptor.hpp"

namespace octopair::test {

/// A socket connected to `unix:PATH` or `127.0.0.1:PORT`.
class RawSocket {
public:
    /// Throws: std::runtime_error if the connection fails.
    explicit RawSocket(const std::string& address);

    int number() const { return socket_.number(); }
    /// Sends bytes. Returns false if the peer is gone, or does not accept all bytes within five seconds.
    bool send(std::string_view bytes) const;
    /// Returns the bytes received until the peer closes or `most` has passed.
    std::string receive(std::chrono::milliseconds most);
    /// Returns whether the peer closes within `most`. Drops received bytes.
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
/// Returns the head of a gRPC call of a method of octopair's service.
std::string grpc_head(std::uint32_t stream, const std::string& method);
/// Returns the first five bytes of a gRPC message.
std::string grpc_prefix(std::uint32_t length);

}  // namespace octopair::test
