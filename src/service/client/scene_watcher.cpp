// SceneWatcher: the calls of a client about running scenes. Every call is retried until the server answers or the timeout passes.
#include "octopair/scene_watcher.hpp"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/byte_buffer.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "octopair/error.hpp"
#include "service/client/connection.hpp"
#include "service/client/raw_stream.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.grpc.pb.h"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

namespace {

/// Puts a snapshot of a scene together from the messages of the call WatchScene.
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
    std::array<std::span<std::byte>, 3> rooms_;  // unfilled parts of the arrays presence, boxes and pairs
};

void ReceivedSnapshot::restart() {
    snapshot_.reset();
    presence_.clear();
    rooms_ = {};
}

void ReceivedSnapshot::take(grpc::ByteBuffer& message) {
    // unpack() passes the data on before the head is parsed. The head has the sizes of the arrays, so keep the data until then.
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

}  // namespace

}  // namespace octopair::service

namespace octopair {

namespace {

SceneStatus scene_status_of(const v1::SceneReport& report) {
    SceneStatus status;
    status.id = report.id();
    status.owner = report.owner();
    status.precision = report.precision() == v1::FLOAT64 ? Precision::float64 : Precision::float32;
    status.margin = report.margin();
    status.objects = report.objects();
    status.pairs = report.pairs();
    status.steps = report.steps();
    status.step_seconds = report.seconds();
    return status;
}

}  // namespace

class SceneWatcher::State {
public:
    State(std::string_view address, const ClientOptions& options)
        : connection_(address, options), calls_(v1::Octopair::NewStub(connection_.channel())) {}

    v1::SceneList list(const v1::ListScenesRequest& request, const std::stop_token& stop) {
        v1::SceneList list;
        connection_.call_with_retries(stop, [&] {
            grpc::ClientContext context;
            connection_.prepare(context);
            const std::stop_callback cancel(stop, [&] { context.TryCancel(); });
            return checked(calls_->ListScenes(&context, request, &list));
        });
        return list;
    }

    std::optional<SceneSnapshot> next(const v1::WatchSceneRequest& request, const std::stop_token& stop) {
        service::ReceivedSnapshot received(connection_.server());
        const auto take = [&](grpc::ByteBuffer& message) { received.take(message); };
        connection_.call_with_retries(stop, [&] {
            received.restart();
            bool asked = false;
            const auto send = [&]() -> std::optional<grpc::ByteBuffer> {
                if (std::exchange(asked, true)) return {};
                return service::pack(request);
            };
            return checked(service::RawStream(connection_, {"/octopair.v1.Octopair/WatchScene", send, take}).run(stop));
        });
        return received.finish();
    }

private:
    /// Returns `status`. Throws: Error{usage} if the server does not have the call.
    const grpc::Status& checked(const grpc::Status& status) const {
        if (status.error_code() != grpc::StatusCode::UNIMPLEMENTED) return status;
        throw Error(ErrorCode::usage,
                    connection_.server() + ": the server is too old: its version of octopair cannot show scenes");
    }

    service::Connection connection_;
    std::unique_ptr<v1::Octopair::Stub> calls_;
};

SceneWatcher::SceneWatcher(std::string_view address, const ClientOptions& options)
    : state_(std::make_unique<State>(address, options)) {}

SceneWatcher::~SceneWatcher() = default;

std::vector<SceneStatus> SceneWatcher::list(std::stop_token stop) {
    std::vector<SceneStatus> scenes;
    v1::ListScenesRequest request;
    for (;;) {
        const v1::SceneList list = state_->list(request, stop);
        for (const v1::SceneReport& report : list.scenes()) scenes.push_back(scene_status_of(report));
        if (!list.more() || list.scenes().empty()) return scenes;
        request.set_after(scenes.back().id);
    }
}

// NOLINTNEXTLINE(readability-function-size): the stop token is the fifth, as in all calls of a client
std::optional<SceneSnapshot> SceneWatcher::next(const std::string& id, std::uint64_t after_step,
                                                std::chrono::duration<double> most, std::uint64_t pair_limit,
                                                std::stop_token stop) {
    using Clock = std::chrono::steady_clock;
    constexpr double at_once = 60;  // seconds for one call, because proxies may end calls that are silent for longer
    const auto begun = Clock::now();
    v1::WatchSceneRequest request;
    request.set_id(id);
    request.set_after_step(after_step);
    request.set_pair_limit(pair_limit);
    for (;;) {
        const double left = most.count() - std::chrono::duration<double>(Clock::now() - begun).count();
        request.set_seconds(std::clamp(left, 0.0, at_once));
        std::optional<SceneSnapshot> snapshot = state_->next(request, stop);
        if (snapshot || left <= at_once) return snapshot;
    }
}

}  // namespace octopair
