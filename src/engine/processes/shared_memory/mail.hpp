// Mail: what the client tells a worker over their socket, which beside that shows each of them whether the other lives.
#pragma once

#include <cstdint>
#include <optional>

#include "base/descriptor.hpp"

namespace octopair {

enum class MailKind : std::uint32_t { region, forget, stop };

struct Mail {
    MailKind kind = MailKind::region;
    std::uint32_t number = 0;  ///< of a region, or of the pass that is to stop
    std::uint64_t bytes = 0;   ///< of a region, whose file comes with it
};

/// The region that the desk is.
inline constexpr std::uint32_t desk_region = 1;

struct SocketPair {
    Descriptor ours, theirs;
};

/// Throws Error{resource_limit}.
SocketPair make_socket_pair();

/// False if the other side is gone or does not read any more.
bool send_mail(const Descriptor& socket, const Mail& mail, int file = -1);

struct Received {
    Mail mail;
    Descriptor file;
};

/// Waits for mail; nothing if the other side is gone.
std::optional<Received> receive_mail(const Descriptor& socket);

}  // namespace octopair
