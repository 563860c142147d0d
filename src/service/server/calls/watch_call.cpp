// The calls about running scenes: ListScenes and WatchScene.
#include "service/server/calls/call_handlers.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/calls/unary_call.hpp"
#include "service/server/scenes/scene_publisher.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

namespace {

using Clock = std::chrono::steady_clock;

/// Maximum number of pairs in a snapshot. Limits how much a watcher can make the scene's thread copy.
constexpr std::uint64_t max_listed_pairs = 1'000'000;

v1::SceneList list_scenes(const ServerContext& server, const Caller& caller, const v1::ListScenesRequest& asked) {
    constexpr std::size_t most = 1000;  // scenes per answer; 1000 reports fit into one message
    auto scenes = server.scenes.of(caller, asked.after(), most + 1);
    v1::SceneList list;
    list.set_more(scenes.size() > most);
    scenes.resize(std::min(scenes.size(), most));
    for (const auto& scene : scenes) {
        v1::SceneReport& report = *list.add_scenes();
        report = scene->report();
        if (caller.name != scene->owner()) report.set_owner(scene->owner());
    }
    return list;
}

/// Cuts a snapshot into messages.
class SnapshotMessages {
public:
    SnapshotMessages(std::shared_ptr<const StepSnapshot> snapshot, std::uint64_t pair_limit)
        : snapshot_(std::move(snapshot)),
          listed_(std::min(snapshot_->listed, pair_limit)),
          size_(std::size_t(snapshot_->pairs_at + listed_ * sizeof(Pair))) {}

    bool done() const { return begun_ && sent_ == size_; }
    /// Throws: std::bad_alloc.
    grpc::ByteBuffer next() {
        v1::SceneSnapshot small;
        if (!begun_) set_head(*small.mutable_head());
        const grpc::Slice piece = make_slice(std::min(size_ - sent_, piece_bytes));
        const std::span<std::byte> room = room_in(piece);
        if (!room.empty()) std::memcpy(room.data(), snapshot_->data.data() + sent_, room.size());
        grpc::ByteBuffer message = pack(small, piece);
        begun_ = true;
        sent_ += room.size();
        return message;
    }

private:
    void set_head(v1::SnapshotHead& head) const {
        const StepNumbers& numbers = snapshot_->numbers;
        head.set_step(numbers.step);
        head.set_precision(snapshot_->precision == Precision::float64 ? v1::FLOAT64 : v1::FLOAT32);
        head.set_indices(snapshot_->indices);
        head.set_listed(listed_);
        head.set_pairs(numbers.pairs);
        head.set_began(numbers.began);
        head.set_ended(numbers.ended);
        head.set_seconds(numbers.seconds);
    }

    std::shared_ptr<const StepSnapshot> snapshot_;
    std::uint64_t listed_;
    std::size_t size_;
    std::size_t sent_ = 0;
    bool begun_ = false;
};

/// The call WatchScene: waits for a snapshot, and sends it.
///
/// Invariants:
///  - At most one write is in progress: `writing_` is true from StartWrite until OnWriteDone.
///  - Nothing is written after `finished_` is true.
///  - The end of each write leads to pump(), so a call with an outcome and without a write finishes.
///  - No lock is held while gRPC is called, because gRPC may call back before it returns.
class WatchCall final : public grpc::ServerWriteReactor<grpc::ByteBuffer>,
                        public SnapshotReceiver,
                        public Watched,
                        public std::enable_shared_from_this<WatchCall> {
public:
    WatchCall(ServerContext& server, grpc::CallbackServerContext& context) : server_(server), context_(context) {}

    void start(const grpc::ByteBuffer& request) {
        self_ = shared_from_this();
        const grpc::Status status = server_.admit(context_, Right::read, admission_);
        if (!status.ok()) return end(status);
        try {
            server_.server_log.received(request.Length());
            const auto asked = parsed<v1::WatchSceneRequest>(request);
            scene_ = server_.scenes.find(admission_.caller, asked.id());
            server_.within_limits(admission_.client(), [&] {
                // A piece stays in memory until the client has read it.
                piece_ = server_.memory.take(piece_bytes, admission_.client());
            });
            start_waiting(asked);
        } catch (...) {
            end(status_of_exception());
        }
    }

    void receive(std::shared_ptr<const StepSnapshot> snapshot, const grpc::Status& failure) override {
        if (!snapshot) return end(failure);
        {
            const std::lock_guard lock(mutex_);
            if (!outcome_) messages_.emplace(std::move(snapshot), pair_limit_);
        }
        pump_soon();
    }

    void check_deadline(Clock::time_point now) override {
        bool stuck = false, over = false;
        {
            const std::lock_guard lock(mutex_);
            if (finished_) return;
            stuck = writing_ && now - since_ >= server_.options.stall;
            over = !messages_ && now >= until_;
        }
        if (stuck) return context_.TryCancel();
        if (server_.draining) return end({grpc::StatusCode::UNAVAILABLE, "the server is going down"});
        if (over) end(grpc::Status::OK);
    }

    void OnWriteDone(bool ok) override {
        {
            const std::lock_guard lock(mutex_);
            writing_ = false;
        }
        ok ? pump_soon() : end({grpc::StatusCode::CANCELLED, "the client does not read"});
    }
    void OnCancel() override { end({grpc::StatusCode::CANCELLED, "cancelled"}); }
    void OnDone() override { self_.reset(); }

private:
    void start_waiting(const v1::WatchSceneRequest& asked) {
        constexpr double most = 60;  // proxies may end calls that are silent for longer
        const double seconds = asked.seconds() > 0 ? std::min(asked.seconds(), most) : 0;
        until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
        pair_limit_ = std::min(asked.pair_limit(), max_listed_pairs);
        server_.watchdog.watch(self_);
        if (auto snapshot = scene_->wait({self_, asked.after_step(), pair_limit_})) receive(std::move(snapshot), {});
    }

    /// Ends the call with `status`, after the write in progress. Only the first status takes effect. A later call still pumps: if
    /// the write in progress fails, OnWriteDone calls only end(), and the call would otherwise never finish.
    void end(const grpc::Status& status) {
        {
            const std::lock_guard lock(mutex_);
            if (!outcome_) outcome_ = status;
        }
        if (scene_) scene_->forget(*this);
        pump();
    }

    /// Calls pump() soon, on the thread that reads results: copying a piece takes some tenths of a millisecond.
    void pump_soon() {
        server_.result_reader.add(admission_.client(), [self = shared_from_this()] { self->pump(); });
    }

    /// Writes the next message if no write is in progress, or finishes the call.
    void pump() {
        std::optional<grpc::Status> last;
        {
            const std::lock_guard lock(mutex_);
            if (writing_ || finished_ || (!outcome_ && !messages_)) return;
            if (!outcome_ && messages_->done()) outcome_ = grpc::Status::OK;
            if (!outcome_) prepare_message();
            last = outcome_;
            finished_ = last.has_value();
            writing_ = !finished_;
        }
        if (last) return Finish(*last);
        server_.server_log.sent(out_.Length());
        StartWrite(&out_);
    }

    /// Requires: mutex_ is locked.
    void prepare_message() {
        try {
            out_ = messages_->next();
            since_ = Clock::now();
        } catch (...) {
            outcome_ = status_of_exception();
        }
    }

    ServerContext& server_;
    grpc::CallbackServerContext& context_;
    std::shared_ptr<WatchCall> self_;  // keeps the object alive until OnDone
    Admission admission_;
    Budget::Reservation piece_;
    std::shared_ptr<ScenePublisher> scene_;
    Clock::time_point until_{};
    std::uint64_t pair_limit_ = 0;

    std::mutex mutex_;
    std::optional<SnapshotMessages> messages_;
    std::optional<grpc::Status> outcome_;
    grpc::ByteBuffer out_;
    Clock::time_point since_{};  // start of the write in progress
    bool writing_ = false;
    bool finished_ = false;
};

}  // namespace

grpc::ServerUnaryReactor* start_list_scenes(ServerContext& server, grpc::CallbackServerContext& context,
                                            const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    return answer_at_once<v1::ListScenesRequest>(
        {server, context, request, response}, Right::see,
        [&](const Caller& caller, const v1::ListScenesRequest& asked) { return list_scenes(server, caller, asked); });
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* start_watch_scene(ServerContext& server,
                                                              grpc::CallbackServerContext& context,
                                                              const grpc::ByteBuffer& request) {
    const auto call = std::make_shared<WatchCall>(server, context);
    call->start(request);
    return call.get();
}

}  // namespace octopair::service
