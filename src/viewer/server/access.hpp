// Access: which requests a page server answers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace octopair::viewer {

/// The parts of a request that decide. Absent headers are empty.
struct AccessRequest {
    std::string_view host, origin, cookie, authorization, token;
    bool has_origin = false;
};

class Access {
public:
    /// `host` and `port`: where the server listens. An empty `token` means that none is needed.
    Access(const std::string& host, std::uint16_t port, std::string token);

    /// Returns whether the request is for this server, from a page of this server, and has the token.
    bool allows(const AccessRequest& request) const;
    /// Returns whether the parameter `token` of the request is right, so that it should become a cookie.
    bool introduces(const AccessRequest& request) const;
    /// Returns the header Set-Cookie that carries the token.
    std::string cookie() const;

private:
    bool is_own(std::string_view host) const;
    bool has_token(const AccessRequest& request) const;

    std::string host_, port_, token_, cookie_name_;
};

/// A connection on this machine: ports of the peer and of the server.
struct LoopbackPorts {
    std::uint16_t peer, server;
};
/// Returns whether a loopback connection was opened by the user of this process or by root. True where the system does not tell.
bool is_own_user(const LoopbackPorts& ports);

}  // namespace octopair::viewer
