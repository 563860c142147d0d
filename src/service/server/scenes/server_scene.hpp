// ServerScene: a client's scene on the server, checked against the server's limits.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "octopair/scene.hpp"
#include "scene/recording/recording_reader.hpp"
#include "service/server/scenes/scene_publisher.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

/// Throws: Error in the cases in which Scene throws; LimitError if a limit is exceeded. The memory limit is checked before
/// memory is allocated, the limit of pairs after a step has found them.
class ServerScene {
public:
    /// `owner`: client that the memory counts for.
    ServerScene(ServerContext& server, const std::string& owner, const SceneOptions& options);
    ServerScene(const ServerScene&) = delete;
    ServerScene& operator=(const ServerScene&) = delete;

    /// Applies `call` to the scene. Steps and results are ignored: use step() for a step.
    void make(const RecordedCall& call);
    const StepResult& step(const std::stop_token& stop);

    /// Returns the numbers of the last step.
    const StepNumbers& numbers() const { return numbers_; }
    /// Copies the state after the last step, with at most `pair_limit` pairs. The copy may use at most half of the memory that is left
    /// to the owner, so that the scene can grow. Requires: no call was made since the step. Throws: LimitError.
    StepSnapshot snapshot(std::uint64_t pair_limit);

private:
    SceneOptions within_limits(SceneOptions options);
    template <typename Real>
    void copy_boxes(std::span<const Box<Real>> boxes, StepSnapshot& snapshot) const;
    void make_room(std::uint64_t objects);

    ServerContext& server_;
    const std::string owner_;
    const Precision precision_;
    Budget::Reservation memory_;
    Scene scene_;
    StepNumbers numbers_;
    std::uint64_t removed_ = 0;  // objects removed since the last step; their indices are not free yet
    std::vector<ObjectId> ids_;  // ids of the latest addition; a member to reuse its memory
};

}  // namespace octopair::service
