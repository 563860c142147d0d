#include "viewer/server/access.hpp"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
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

/// Returns an endpoint as the tables of the system write it: the 32-bit words of the address and the port, in hexadecimal. With
/// `ipv6`, an IPv4 address is written as IPv6. Empty if the table cannot have the endpoint.
std::string table_text(const Endpoint& endpoint, bool ipv6) {
    std::array<unsigned char, 16> bytes = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0, 0, 0, 0};
    std::size_t begin = ipv6 ? 0 : 12;
    if (::inet_pton(AF_INET, endpoint.address.c_str(), bytes.data() + 12) != 1 &&
        (!ipv6 || ::inet_pton(AF_INET6, endpoint.address.c_str(), bytes.data()) != 1)) {
        return {};
    }
    std::string text;
    std::array<char, 16> part;
    for (; begin < bytes.size(); begin += 4) {
        std::uint32_t word = 0;
        std::memcpy(&word, bytes.data() + begin, sizeof word);
        std::snprintf(part.data(), part.size(), "%08X", word);
        text += part.data();
    }
    std::snprintf(part.data(), part.size(), ":%04X", endpoint.port);
    return text + part.data();
}

enum class Owner : std::uint8_t { ours, other, unknown };

/// Looks the peer's socket up in a table of the system. A line has the number, the local and the remote endpoint, the state, the
/// queues, the timer, the retransmissions, and the user. Sockets in other states than "established" have no user.
Owner owner_in(const char* table, const std::string& peer, const std::string& server) {
    constexpr std::string_view established = "01";
    std::ifstream lines(table);
    std::string line;
    std::getline(lines, line);
    while (!peer.empty() && std::getline(lines, line)) {
        std::istringstream fields(line);
        std::string number, local, remote, state, queues, timer, retransmissions;
        unsigned long user = 0;
        if (!(fields >> number >> local >> remote >> state >> queues >> timer >> retransmissions >> user)) continue;
        if (local != peer || remote != server || state != established) continue;
        return user == 0 || user == ::getuid() ? Owner::ours : Owner::other;
    }
    return Owner::unknown;
}

/// Returns whether the text is a numeric address.
bool is_numeric(std::string_view host) {
    std::string text(host);
    if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
    std::array<unsigned char, 16> bytes;
    return ::inet_pton(AF_INET, text.c_str(), bytes.data()) == 1 ||
           ::inet_pton(AF_INET6, text.c_str(), bytes.data()) == 1;
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
    const bool loopback = host_ == "127.0.0.1" || host_ == "[::1]", all = host_ == "0.0.0.0" || host_ == "[::]";
    if (name == host_ || ((loopback || all) && name == "localhost")) return true;
    // A server that listens on all addresses accepts each numeric address in Host. Host names are refused: an attacker's domain could
    // resolve to this machine (DNS rebinding).
    return all && is_numeric(name);
}

bool Access::has_token(const AccessRequest& request) const {
    if (token_.empty()) return true;
    constexpr std::string_view bearer = "bearer ";
    return equal_secrets(cookie_of(request.cookie, cookie_name_), token_) || introduces(request) ||
           (lower(request.authorization.substr(0, bearer.size())) == bearer &&
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

bool is_own_user(const Endpoint& peer, const Endpoint& server) {
    for (const bool ipv6 : {false, true}) {
        const Owner owner =
            owner_in(ipv6 ? "/proc/net/tcp6" : "/proc/net/tcp", table_text(peer, ipv6), table_text(server, ipv6));
        if (owner != Owner::unknown) return owner == Owner::ours;
    }
    return false;
}

}  // namespace octopair::viewer
