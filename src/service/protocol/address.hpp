// Where a server listens and clients find it: `unix:PATH` or `HOST:PORT`.
#pragma once

#include <sys/socket.h>

#include <string>
#include <string_view>

namespace octopair::service {

struct Address {
    std::string path;  ///< of a Unix socket; empty: host and port
    std::string host;  ///< a name or a number; of IPv6 without brackets
    std::string port;

    bool is_unix() const { return !path.empty(); }
    /// As it was written, and as gRPC takes it.
    std::string text() const;
};

/// Throws Error{usage} for what is no address.
Address parse_address(std::string_view text);

/// 127.0.0.0/8 or ::1.
bool is_loopback(const sockaddr& address);
/// A Unix socket, or a host that is nothing but loopback: what is sent there stays on this machine. False for a name that
/// is not known.
bool is_this_machine(const Address& address);

}  // namespace octopair::service
