// ReceivedSnapshot: puts a scene's snapshot together from the messages of the call WatchScene.
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octopair/scene_watcher.hpp"

namespace octopair::v1 {
class SnapshotHead;
}  // namespace octopair::v1

namespace octopair::service {

class ReceivedSnapshot {
public:
    /// `server` names the server in error messages. Requires: it outlives this object.
    explicit ReceivedSnapshot(const std::string& server) : server_(server) {}

    /// Forgets everything that was received.
    void restart();
    /// Processes a message of the server. Throws: Error{engine_failed} if the message is invalid.
    void take(grpc::ByteBuffer& message);
    /// Returns the snapshot, or nothing if no message came. Throws: Error{engine_failed} if the snapshot is incomplete.
    std::optional<SceneSnapshot> finish();

private:
    void begin(const v1::SnapshotHead& head);
    void append(std::span<const std::byte> piece);
    [[noreturn]] void refuse_message() const;

    const std::string& server_;
    std::optional<SceneSnapshot> snapshot_;
    std::vector<std::byte> presence_;
    std::array<std::span<std::byte>, 3> rooms_;  // parts of presence, boxes and pairs that were not received yet
};

}  // namespace octopair::service
