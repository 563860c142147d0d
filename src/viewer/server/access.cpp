#include "viewer/server/access.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace octopair::viewer {

namespace {

/// Compares in a time that does not depend on where the texts differ.
bool equal_secrets(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    unsigned char difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
    return difference == 0;
}

std::string lower(std::string_view text) {
    std::string out(text);
    std::transform(out.begin(), out.end(), out.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? char(c | 0x20) : c; });
    return out;
}

/// Returns the value of a cookie; empty if the header has none of this name.
std::string_view cookie_of(std::string_view header, std::string_view name) {
    while (!header.empty()) {
        const std::size_t end = std::min(header.find(';'), header.size());
        std::string_view field = header.substr(0, end);
        field.remove_prefix(std::min(field.find_first_not_of(' '), field.size()));
        if (field.starts_with(name) && field.substr(name.size()).starts_with('=')) return field.substr(name.size() + 1);
        header.remove_prefix(std::min(end + 1, header.size()));
    }
    return {};
}

unsigned port_of(const std::string& hex_endpoint) {
    const std::size_t colon = hex_endpoint.rfind(':');
    unsigned port = 0;
    if (colon != std::string::npos) std::sscanf(hex_endpoint.c_str() + colon + 1, "%x", &port);
    return port;
}

enum class Owner : std::uint8_t { ours, other, unknown };

/// Looks the peer's socket up in a table of the system. A line has the number, the local and the remote endpoint, the state, the
/// queues, the timer, the retransmissions, and the user.
Owner owner_in(const char* table, const LoopbackPorts& ports) {
    std::ifstream lines(table);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        std::istringstream fields(line);
        std::string number, local, remote, state, queues, timer, retransmissions;
        unsigned long user = 0;
        if (!(fields >> number >> local >> remote >> state >> queues >> timer >> retransmissions >> user)) continue;
        if (port_of(local) != ports.peer || port_of(remote) != ports.server) continue;
        return user == 0 || user == ::getuid() ? Owner::ours : Owner::other;
    }
    return Owner::unknown;
}

}  // namespace

Access::Access(const std::string& host, std::uint16_t port, std::string token)
    : host_(host.find(':') == std::string::npos ? host : '[' + host + ']'),
      port_(std::to_string(port)),
      token_(std::move(token)),
      cookie_name_("octopair_" + port_) {}

bool Access::is_own(std::string_view host) const {
    const std::string text = lower(host), suffix = ':' + port_;
    if (!text.ends_with(suffix)) return port_ == "80" && (text == host_ || text == "localhost");
    const std::string_view name = std::string_view(text).substr(0, text.size() - suffix.size());
    const bool loopback = host_ == "127.0.0.1" || host_ == "[::1]";
    if (name == host_ || (loopback && name == "localhost")) return true;
    // Listening on all addresses: the token decides. Names are refused, so that no foreign name can lead here.
    const bool all = host_ == "0.0.0.0" || host_ == "[::]";
    return all && name.find_first_not_of("0123456789.:abcdef[]") == std::string_view::npos;
}

bool Access::has_token(const AccessRequest& request) const {
    if (token_.empty()) return true;
    constexpr std::string_view bearer = "Bearer ";
    return equal_secrets(cookie_of(request.cookie, cookie_name_), token_) || introduces(request) ||
           (request.authorization.starts_with(bearer) &&
            equal_secrets(request.authorization.substr(bearer.size()), token_));
}

bool Access::allows(const AccessRequest& request) const {
    if (!is_own(request.host)) return false;
    constexpr std::string_view scheme = "http://";
    if (request.has_origin &&
        !(request.origin.starts_with(scheme) && lower(request.origin.substr(scheme.size())) == lower(request.host))) {
        return false;
    }
    return has_token(request);
}

bool Access::introduces(const AccessRequest& request) const {
    return !token_.empty() && equal_secrets(request.token, token_);
}

std::string Access::cookie() const { return cookie_name_ + '=' + token_ + "; Path=/; HttpOnly; SameSite=Strict"; }

bool is_own_user(const LoopbackPorts& ports) {
    for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
        const Owner owner = owner_in(table, ports);
        if (owner != Owner::unknown) return owner == Owner::ours;
    }
    return !std::ifstream("/proc/net/tcp").is_open();
}

}  // namespace octopair::viewer
