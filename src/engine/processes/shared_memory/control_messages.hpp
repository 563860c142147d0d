// ControlMessage: what the client tells a worker over their socket, which beside that shows each of them whether the other lives.
#pragma once

#include <cstdint>
#include <optional>

#include "base/descriptor.hpp"

namespace octopair {

enum class ControlMessageKind : std::uint32_t { region, forget, stop };

struct ControlMessage {
    ControlMessageKind kind = ControlMessageKind::region;
    std::uint32_t number = 0;  ///< of a region, or of the pass that is to stop
    std::uint64_t bytes = 0;   ///< of a region, whose file comes with it
};

/// The region that the control block is.
inline constexpr std::uint32_t control_region = 1;

struct SocketPair {
    Descriptor ours, theirs;
};

/// Throws Error{resource_limit}.
SocketPair make_socket_pair();

/// False if the other side is gone or does not read any more.
bool send_message(const Descriptor& socket, const ControlMessage& message, int file = -1);

struct ReceivedMessage {
    ControlMessage message;
    Descriptor file;
};

/// Waits for message; nothing if the other side is gone.
std::optional<ReceivedMessage> receive_message(const Descriptor& socket);

}  // namespace octopair
