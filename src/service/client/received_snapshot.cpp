#include "service/client/received_snapshot.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>
#include <variant>

#include "octopair/error.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

void ReceivedSnapshot::restart() {
    snapshot_.reset();
    presence_.clear();
    rooms_ = {};
}

void ReceivedSnapshot::take(grpc::ByteBuffer& message) {
    // The head is parsed together with the data of its message, but needed before. So the data are kept until then.
    std::vector<std::byte> data;
    v1::SceneSnapshot small;
    if (!unpack(message, small,
                [&](std::span<const std::byte> piece) { data.insert(data.end(), piece.begin(), piece.end()); }) ||
        small.has_head() == snapshot_.has_value())
        refuse_message();
    if (small.has_head()) begin(small.head());
    append(data);
}

std::optional<SceneSnapshot> ReceivedSnapshot::finish() {
    if (!snapshot_) return {};
    if (std::any_of(rooms_.begin(), rooms_.end(), [](const auto& room) { return !room.empty(); })) {
        throw Error(ErrorCode::engine_failed, server_ + ": the answer ended in the middle of a snapshot");
    }
    std::vector<bool>& exists = snapshot_->exists;
    for (std::size_t i = 0; i < exists.size(); ++i)
        exists[i] = (presence_[i / 8] >> i % 8 & std::byte(1)) != std::byte(0);
    return std::exchange(snapshot_, std::nullopt);
}

void ReceivedSnapshot::begin(const v1::SnapshotHead& head) {
    if (head.indices() > std::numeric_limits<std::uint32_t>::max() || head.listed() > head.pairs()) refuse_message();
    const auto indices = std::size_t(head.indices());
    snapshot_.emplace();
    snapshot_->step = head.step();
    snapshot_->pairs = head.pairs();
    snapshot_->began = head.began();
    snapshot_->ended = head.ended();
    snapshot_->step_seconds = head.seconds();
    snapshot_->exists.resize(indices);
    if (head.precision() == v1::FLOAT64) snapshot_->boxes.emplace<std::vector<Box3d>>();
    snapshot_->listed.resize(std::size_t(head.listed()));
    presence_.resize((indices + 7) / 8);
    rooms_[0] = presence_;
    std::visit(
        [&](auto& boxes) {
            boxes.resize(indices);
            rooms_[1] = std::as_writable_bytes(std::span(boxes));
        },
        snapshot_->boxes);
    rooms_[2] = std::as_writable_bytes(std::span(snapshot_->listed));
}

void ReceivedSnapshot::append(std::span<const std::byte> piece) {
    for (std::span<std::byte>& room : rooms_) {
        const std::size_t bytes = std::min(room.size(), piece.size());
        if (bytes > 0) std::memcpy(room.data(), piece.data(), bytes);
        room = room.subspan(bytes);
        piece = piece.subspan(bytes);
    }
    if (!piece.empty()) refuse_message();
}

void ReceivedSnapshot::refuse_message() const {
    throw Error(ErrorCode::engine_failed, server_ + ": the answer is not a valid message of octopair's protocol");
}

}  // namespace octopair::service
