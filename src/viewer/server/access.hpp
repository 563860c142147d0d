// Access: which requests a page server answers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace octopair::viewer {

/// The headers and the parameter `token` of a request, from which Access decides. Absent headers are empty.
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
    /// Returns whether the request has the right token as its parameter `token`. The server then sets the token as a cookie.
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
/// Returns whether the user of this process, or root, opened a connection on this machine. Reads the tables of sockets in /proc/net
/// (Linux). Returns false if there are no such tables.
bool is_own_user(const Endpoint& peer, const Endpoint& server);

}  // namespace octopair::viewer
