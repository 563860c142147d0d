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

/// An end of a connection: a numeric address, such as 127.0.0.1 or ::1, and a port.
struct Endpoint {
    std::string address;
    std::uint16_t port;
};
/// Returns whether a connection on this machine was opened by the user of this process or by root. The tables of sockets in /proc/net
/// (Linux) tell; false without them.
bool is_own_user(const Endpoint& peer, const Endpoint& server);

}  // namespace octopair::viewer
