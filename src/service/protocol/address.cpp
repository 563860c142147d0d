#include "service/protocol/address.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstdint>
#include <memory>

#include "octopair/error.hpp"

namespace octopair::service {

namespace {

constexpr std::string_view unix_prefix = "unix:";

[[noreturn]] void refuse(std::string_view text, const char* why) {
    std::string shown(text);
    std::replace_if(
        shown.begin(), shown.end(), [](char c) { return (c >= 0 && c < ' ') || c == 127; }, '?');
    throw Error(ErrorCode::usage, "address '" + shown + "' " + why + "; give unix:PATH or HOST:PORT");
}

constexpr std::string_view decimal_digits = "0123456789";
/// Characters of host names, and of the names of network interfaces.
constexpr std::string_view name_characters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz.-_";

bool is_name(std::string_view text) {
    return !text.empty() && text.find_first_not_of(name_characters) == std::string_view::npos;
}

bool is_numeric(int family, std::string_view text) {
    in6_addr address;
    if (text.find('\0') != std::string_view::npos) return false;
    return ::inet_pton(family, std::string(text).c_str(), &address) == 1;
}

/// Returns whether the last part of `host` is a number. getaddrinfo() reads such a host as an IPv4 address in one of many forms:
/// 127.1, 0x7f.0.0.1 and 0177.0.0.1 are 127.0.0.1, but 127.0.0.011 is 127.0.0.9.
bool ends_in_number(std::string_view host) {
    if (host.ends_with('.')) host.remove_suffix(1);
    const std::string_view last = host.substr(host.rfind('.') + 1);
    if (last.starts_with("0x") || last.starts_with("0X"))
        return last.find_first_not_of("0123456789abcdefABCDEF", 2) == std::string_view::npos;
    return !last.empty() && last.find_first_not_of(decimal_digits) == std::string_view::npos;
}

/// Returns whether `text` is an IPv6 address, with a network interface behind % or without.
bool is_ipv6(std::string_view text) {
    const std::size_t percent = text.find('%');
    return is_numeric(AF_INET6, text.substr(0, percent)) &&
           (percent == std::string_view::npos || is_name(text.substr(percent + 1)));
}

bool is_port(std::string_view text) {
    return !text.empty() && text.size() <= 5 && text.find_first_not_of(decimal_digits) == std::string_view::npos &&
           std::stoul(std::string(text)) <= 65535;
}

/// Returns a path for a URI. Characters such as % ? # and blanks are written as %25, because gRPC would connect to another path, or to
/// none.
std::string escaped(std::string_view path) {
    constexpr std::string_view plain = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-._~/:";
    constexpr std::string_view hexadecimal = "0123456789ABCDEF";
    std::string text;
    for (const char c : path) {
        if (plain.find(c) != std::string_view::npos) {
            text += c;
        } else {
            text += {'%', hexadecimal[std::uint8_t(c) >> 4], hexadecimal[std::uint8_t(c) & 15]};
        }
    }
    return text;
}

}  // namespace

std::string Address::text() const {
    if (is_unix()) return std::string(unix_prefix) + path;
    return host.find(':') == std::string::npos ? host + ":" + port : "[" + host + "]:" + port;
}

std::string Address::uri() const {
    // Always write the scheme "dns:". Without a scheme, gRPC would read a host that is called "dns", as in dns:50051, as a scheme.
    if (!is_unix()) return "dns:///" + escaped(text());
    std::string_view rest = path;
    // In a URI, two slashes would begin the name of a machine. So keep one slash of several.
    while (rest.starts_with("//")) rest.remove_prefix(1);
    return std::string(unix_prefix) + escaped(rest);
}

Address parse_address(std::string_view text) {
    constexpr std::size_t longest_path = 107;  // sockaddr_un::sun_path, without its terminating 0
    if (text.substr(0, unix_prefix.size()) == unix_prefix) {
        const std::string_view path = text.substr(unix_prefix.size());
        if (path.empty()) refuse(text, "names no path");
        if (path.size() > longest_path) refuse(text, "has a path of more than 107 bytes, which no socket can have");
        if (path.find('\0') != std::string_view::npos) refuse(text, "has a byte 0 in its path");
        return {std::string(path), {}, {}};
    }
    const std::size_t colon = text.rfind(':');
    if (colon == std::string_view::npos) refuse(text, "has no port");
    std::string_view host = text.substr(0, colon);
    const std::string_view port = text.substr(colon + 1);
    if (!is_port(port)) refuse(text, "has no port from 0 to 65535");
    if (host.size() >= 2 && host.front() == '[' && host.back() == ']') {
        host = host.substr(1, host.size() - 2);
        if (!is_ipv6(host)) refuse(text, "has no IPv6 address in its brackets");
        return {{}, std::string(host), std::string(port)};
    }
    if (host.find(':') != std::string_view::npos) refuse(text, "has an IPv6 address without brackets");
    if (host.empty()) refuse(text, "names no host");
    if (!is_name(host)) refuse(text, "has a character in its host that no host name can have");
    if (ends_in_number(host) && !is_numeric(AF_INET, host))
        refuse(text, "has no IPv4 address: four numbers from 0 to 255 without zeros in front");
    return {{}, std::string(host), std::string(port)};
}

bool is_loopback(const sockaddr& address) {
    if (address.sa_family == AF_INET) {
        return ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr) >> 24 == 127;
    }
    return address.sa_family == AF_INET6 &&
           IN6_IS_ADDR_LOOPBACK(&reinterpret_cast<const sockaddr_in6&>(address).sin6_addr);
}

bool is_this_machine(const Address& address) {
    if (address.is_unix()) return true;
    addrinfo hints{}, *list = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    if (::getaddrinfo(address.host.c_str(), nullptr, &hints, &list) != 0) return false;
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(list, &::freeaddrinfo);
    for (const addrinfo* one = list; one != nullptr; one = one->ai_next) {
        if (!is_loopback(*one->ai_addr)) return false;
    }
    return true;
}

}  // namespace octopair::service
