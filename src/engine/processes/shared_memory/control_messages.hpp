// ControlMessage: a message from the client to a worker, sent over a socket pair.
//
// Each side also detects the end of the other side by its socket.
#pragma once

#include <cstdint>
#include <optional>

#include "base/descriptor.hpp"

namespace octopair {

enum class ControlMessageKind : std::uint32_t { region, forget, stop };

struct ControlMessage {
    ControlMessageKind kind = ControlMessageKind::region;
    std::uint32_t number = 0;  ///< number of the region, or of the pass to stop
    std::uint64_t bytes = 0;   ///< size of the region, whose file descriptor is attached
};

/// Region number of the control block.
inline constexpr std::uint32_t control_region = 1;

struct SocketPair {
    Descriptor ours, theirs;
};

/// Throws: Error{resource_limit}.
SocketPair make_socket_pair();

/// Sends `message`, with the descriptor `file` if that is >= 0. Never blocks. Returns false if the message cannot be sent: the
/// other side has ended, or has stopped reading.
bool send_message(const Descriptor& socket, const ControlMessage& message, int file = -1);

struct ReceivedMessage {
    ControlMessage message;
    Descriptor file;
};

/// Waits for a message. Returns nothing if the other side has ended.
std::optional<ReceivedMessage> receive_message(const Descriptor& socket);

}  // namespace octopair
