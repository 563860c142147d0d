#include "service/server/calls/server_scene.hpp"

#include <algorithm>
#include <string>

#include "scene/recording/replay.hpp"
#include "service/protocol/limit_error.hpp"

namespace octopair::service {

namespace {

// Memory for each object, as octopair/scene.hpp documents.
constexpr std::uint64_t object_bytes = 120;
/// Memory for messages in transit and the calls decoded from them.
constexpr std::uint64_t own_bytes = std::uint64_t(4) << 20;

}  // namespace

ServerScene::ServerScene(ServerContext& server, const std::string& owner, const SceneOptions& options)
    : server_(server), memory_(server.memory.take(own_bytes, owner)), scene_(within_limits(options)) {}

SceneOptions ServerScene::within_limits(SceneOptions options) {
    options.threads = server_.options.engine_widths.large;
    options.room_for_pairs = [this](std::uint64_t bytes) { memory_.grow(bytes); };
    return options;
}

void ServerScene::make(const RecordedCall& call) {
    if (call.kind == RecordKind::add) make_room(call.objects.size());
    change_scene(scene_, call, ids_);
    if (call.kind == RecordKind::remove) removed_ += call.ids.size();
}

/// Memory is needed for each index, even if no object has the index at the moment.
void ServerScene::make_room(std::uint64_t objects) {
    const std::uint64_t free = scene_.indices() - scene_.size() - removed_;
    const std::uint64_t fresh = objects - std::min(objects, free), all = scene_.indices() + fresh;
    const std::uint64_t allowed = server_.options.limits.objects;
    if (allowed > 0 && all > allowed) {
        throw LimitError("objects", allowed,
                         "a scene of " + std::to_string(all) + " objects; at most " + std::to_string(allowed));
    }
    memory_.grow(fresh * object_bytes);
}

const StepResult& ServerScene::step(const std::stop_token& stop) {
    const StepResult& result = scene_.step(stop);
    removed_ = 0;
    const std::uint64_t most = server_.options.limits.pairs;
    if (most > 0 && result.pairs() > most) {
        throw LimitError("pairs", most,
                         std::to_string(result.pairs()) + " pairs in a scene; at most " + std::to_string(most));
    }
    return result;
}

}  // namespace octopair::service
