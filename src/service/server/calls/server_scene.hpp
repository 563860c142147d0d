// ServerScene: a client's scene on the server, within the server's limits.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "octopair/scene.hpp"
#include "scene/recording/recording_reader.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

/// Throws Error as Scene does, and a LimitError where a limit would be passed: of memory before it is taken, of pairs once a
/// step has found them.
class ServerScene {
public:
    ServerScene(ServerContext& server, const SceneOptions& options);
    ServerScene(const ServerScene&) = delete;
    ServerScene& operator=(const ServerScene&) = delete;

    /// Any but a step.
    void make(const RecordedCall& call);
    const StepResult& step(const std::stop_token& stop);

private:
    SceneOptions within_limits(SceneOptions options);
    void make_room(std::uint64_t objects);

    ServerContext& server_;
    Budget::Reservation memory_;
    Scene scene_;
    std::uint64_t removed_ = 0;  // since the last step: their indices are not free yet
    std::vector<ObjectId> ids_;  // of an addition
};

}  // namespace octopair::service
