#include "service/protocol/address.hpp"

#include <netdb.h>
#include <netinet/in.h>

#include <algorithm>
#include <memory>

#include "octopair/error.hpp"

namespace octopair::service {

namespace {

constexpr std::string_view unix_prefix = "unix:";

[[noreturn]] void refuse(std::string_view text, const char* why) {
    throw Error(ErrorCode::usage, "address '" + std::string(text) + "' " + why + "; give unix:PATH or HOST:PORT");
}

bool may_be_in_host(char c) { return c > ' ' && c != 127 && c != '[' && c != ']'; }

bool is_port(std::string_view text) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    return !text.empty() && text.size() <= 5 && std::all_of(text.begin(), text.end(), is_digit) &&
           std::stoul(std::string(text)) <= 65535;
}

}  // namespace

std::string Address::text() const {
    if (is_unix()) return std::string(unix_prefix) + path;
    return host.find(':') == std::string::npos ? host + ":" + port : "[" + host + "]:" + port;
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
        if (host.find(':') == std::string_view::npos) refuse(text, "has no IPv6 address in its brackets");
    } else if (host.find(':') != std::string_view::npos) {
        refuse(text, "has an IPv6 address without brackets");
    }
    if (host.empty()) refuse(text, "names no host");
    if (!std::all_of(host.begin(), host.end(), may_be_in_host))
        refuse(text, "has a character in its host that no host name can have");
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
