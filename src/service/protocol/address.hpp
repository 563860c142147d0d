// Address: where a server listens and clients connect: `unix:PATH` or `HOST:PORT`.
#pragma once

#include <sys/socket.h>

#include <string>
#include <string_view>

namespace octopair::service {

struct Address {
    std::string path;  ///< path of a Unix socket; empty: the address has host and port
    std::string host;  ///< name or numeric address; IPv6 without brackets
    std::string port;  ///< decimal, 0 to 65535

    bool is_unix() const { return !path.empty(); }
    /// Returns the address in the form that parse_address() accepts.
    std::string text() const;
    /// Returns the address as a URI, which gRPC's clients expect.
    std::string uri() const;
};

/// Returns the address that `text` names. Throws: Error{usage} if it is not a valid address.
Address parse_address(std::string_view text);

/// Returns whether the address is in 127.0.0.0/8, or is ::1.
bool is_loopback(const sockaddr& address);
/// Returns whether data sent to `address` stays on this machine: it is a Unix socket, or all addresses of its host are
/// loopback. False for a host name that cannot be resolved.
bool is_this_machine(const Address& address);

}  // namespace octopair::service
