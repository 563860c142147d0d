#include "service/server/scenes/server_scene.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <variant>

#include "scene/recording/replay.hpp"
#include "service/protocol/errors.hpp"

namespace octopair::service {

namespace {

// Memory for each object, as octopair/scene.hpp documents.
constexpr std::uint64_t object_bytes = 120;
/// Memory for messages in transit and the calls decoded from them.
constexpr std::uint64_t own_bytes = std::uint64_t(4) << 20;

/// Returns the size of the bits that mark the indices with objects.
constexpr std::uint64_t presence_bytes(std::uint64_t indices) { return (indices + 7) / 8; }

/// Copies pairs until `out` is full. Requires: there are as many pairs.
void copy_pairs(const PairList& pairs, std::span<std::byte> out) {
    for (const std::span<const Pair> chunk : pairs.chunks()) {
        const std::size_t bytes = std::min(chunk.size_bytes(), out.size());
        if (bytes == 0) return;
        std::memcpy(out.data(), chunk.data(), bytes);
        out = out.subspan(bytes);
    }
}

}  // namespace

ServerScene::ServerScene(ServerContext& server, const std::string& owner, const SceneOptions& options)
    : server_(server),
      owner_(owner),
      precision_(options.precision),
      memory_(server.memory.take(own_bytes, owner)),
      scene_(within_limits(options)) {}

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

/// Reserves memory for `objects` new objects. Every index takes memory, even while no object has the index.
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
    numbers_ = {.step = numbers_.step + 1,
                .objects = scene_.size(),
                .pairs = result.pairs(),
                .began = result.began.size(),
                .ended = result.ended.size(),
                .seconds = result.seconds};
    const std::uint64_t most = server_.options.limits.pairs;
    if (most > 0 && result.pairs() > most) {
        throw LimitError("pairs", most,
                         std::to_string(result.pairs()) + " pairs in a scene; at most " + std::to_string(most));
    }
    return result;
}

StepSnapshot ServerScene::snapshot(std::uint64_t pair_limit) {
    StepSnapshot snapshot;
    snapshot.numbers = numbers_;
    snapshot.precision = precision_;
    snapshot.indices = scene_.indices();
    snapshot.listed = std::min(pair_limit, numbers_.pairs);
    const std::uint64_t box_bytes = precision_ == Precision::float64 ? sizeof(Box3d) : sizeof(Box3f);
    snapshot.pairs_at = presence_bytes(snapshot.indices) + snapshot.indices * box_bytes;
    const std::uint64_t all = snapshot.pairs_at + snapshot.listed * sizeof(Pair);
    snapshot.memory = server_.memory.take(2 * all, owner_);
    snapshot.memory.shrink(all);
    snapshot.data.resize_discard(all);
    std::visit([&](auto boxes) { copy_boxes(boxes, snapshot); }, scene_.boxes());
    if (snapshot.listed > 0) copy_pairs(scene_.pairs(), snapshot.data.span().subspan(snapshot.pairs_at));
    return snapshot;
}

template <typename Real>
void ServerScene::copy_boxes(std::span<const Box<Real>> boxes, StepSnapshot& snapshot) const {
    const std::uint64_t presence = presence_bytes(snapshot.indices);
    std::fill_n(snapshot.data.data(), presence, std::byte(0));
    for (std::uint32_t i = 0; i < snapshot.indices; ++i) {
        if (scene_.exists(i)) snapshot.data[i / 8] |= std::byte(1 << i % 8);
    }
    if (!boxes.empty()) std::memcpy(snapshot.data.data() + presence, boxes.data(), boxes.size_bytes());
}

}  // namespace octopair::service
