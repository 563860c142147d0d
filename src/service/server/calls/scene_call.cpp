// The call Scene: runs a scene of a client.
#include "service/server/calls/call_handlers.hpp"

#include <grpcpp/server_context.h>

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "service/protocol/errors.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/scenes/scene_publisher.hpp"
#include "service/server/scenes/server_scene.hpp"
#include "service/server/scenes/uploaded_calls.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

namespace {

using Clock = std::chrono::steady_clock;

/// Returns the concatenation of `first` and `second` from `offset` on, at most `piece_bytes` bytes.
grpc::Slice piece_of(Bytes first, Bytes second, std::size_t offset) {
    grpc::Slice piece = make_slice(std::min(first.size() + second.size() - offset, piece_bytes));
    std::span<std::byte> room = room_in(piece);
    for (const Bytes part : {first, second}) {
        const std::size_t skipped = std::min(offset, part.size()), count = std::min(part.size() - skipped, room.size());
        if (count > 0) std::memcpy(room.data(), part.data() + skipped, count);
        offset -= skipped;
        room = room.subspan(count);
    }
    return piece;
}

/// The call Scene, with a thread of its own. The thread reads the messages, steps the scene and writes the answers; it alone
/// starts reads and writes. Threads of gRPC report finished reads and writes, and the watchdog ends the call when it takes too
/// long.
class SceneCall final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                        public Watched,
                        public std::enable_shared_from_this<SceneCall> {
public:
    SceneCall(ServerContext& server, grpc::CallbackServerContext& context) : server_(server), context_(context) {}

    void start() {
        self_ = shared_from_this();
        const grpc::Status status = server_.admit(context_, Right::submit, admission_);
        if (!status.ok()) return Finish(status);
        try {
            slot_ = server_.job_slots.take(1, admission_.client());
            server_.threads.start([call = self_] { call->work(); });
        } catch (const LimitError& error) {
            return Finish(refused(error));
        } catch (...) {
            return Finish(status_of_exception());
        }
        server_.watchdog.watch(self_);
    }

    void OnReadDone(bool ok) override {
        set([&] { read_ = ok ? Read::came : Read::ended; });
    }
    void OnWriteDone(bool ok) override {
        set([&] {
            doing_ = Doing::working;
            broken_ |= !ok;
        });
    }
    void OnCancel() override { end_by({grpc::StatusCode::CANCELLED, "cancelled"}); }
    void OnDone() override { self_.reset(); }

    void check_deadline(Clock::time_point now) override {
        Doing late = Doing::working;
        {
            const std::lock_guard lock(mutex_);
            if (is_late(now)) late = doing_;
        }
        switch (late) {
            case Doing::working:
                return;
            case Doing::idle:
                return end_by({grpc::StatusCode::UNAVAILABLE, "the server is going down"});
            case Doing::waiting:
                return end_by(stalled());
            case Doing::stepping:
                return end_by(stepped_too_long());
            case Doing::writing:
                return context_.TryCancel();
        }
    }

private:
    enum class Read : std::uint8_t { none, came, ended };
    /// What the thread of the call does. idle: waits for the first message of a frame. waiting: waits for the rest of a frame.
    enum class Doing : std::uint8_t { working, idle, waiting, stepping, writing };

    void work() {
        grpc::Status status;
        try {
            StartRead(&in_);
            while (take_message()) {
            }
        } catch (const LimitError& error) {
            status = refused(error);
        } catch (...) {
            status = status_of_exception();
        }
        if (publisher_) {
            server_.scenes.remove(*publisher_);
            publisher_->close();
        }
        scene_.reset();
        slot_ = {};
        {
            const std::lock_guard lock(mutex_);
            if (refusal_) status = *refusal_;
        }
        Finish(status);
    }

    /// Processes the next message. Returns false at the end of the call.
    bool take_message() {
        if (!wait_for_message()) return false;
        StartRead(&in_);  // reads the next message while this one is processed
        server_.server_log.received(message_.Length());
        v1::SceneUpload small;
        if (!unpack(message_, small, [this](Bytes piece) { calls_.append(piece); })) {
            throw Error(ErrorCode::bad_input, "the message cannot be parsed");
        }
        message_.Clear();
        for (RecordedCall call; calls_.next(call);) {
            if (!scene_) start_scene(calls_.options());
            call.kind == RecordKind::step ? step() : scene_->make(call);
            if (call.kind != RecordKind::result) in_frame_ = call.kind != RecordKind::step;
        }
        in_frame_ |= calls_.is_incomplete();
        return true;
    }

    void start_scene(const SceneOptions& options) {
        scene_.emplace(server_, admission_.client(), options);
        ScenePublisher::Description scene;
        scene.owner = admission_.client();
        scene.precision = options.precision;
        scene.margin = options.margin;
        scene.wake = [this] { set([] {}); };
        publisher_ = std::make_shared<ScenePublisher>(std::move(scene), server_.result_reader);
        server_.scenes.enter(publisher_);
    }

    bool wait_for_message() {
        std::unique_lock lock(mutex_);
        if (in_frame_) {
            begin(Doing::waiting);
            changed_.wait(lock, [&] { return has_news(); });
        } else {
            wait_idle(lock);
        }
        begin(Doing::working);
        if (refusal_) return false;
        if (read_ == Read::came) {
            in_.Swap(&message_);
            read_ = Read::none;
            return true;
        }
        if (!in_frame_) return false;
        throw Error(ErrorCode::bad_input, "the upload ended in the middle of a frame");
    }

    /// Returns whether a message has arrived or the call must end. Requires: mutex_ is locked.
    bool has_news() const { return read_ != Read::none || refusal_; }

    /// Waits between frames, and publishes the scene if a watcher comes.
    void wait_idle(std::unique_lock<std::mutex>& lock) {
        for (;;) {
            begin(Doing::idle);
            changed_.wait(lock, [&] { return has_news() || publisher_->is_wanted(); });
            if (has_news()) return;
            if (changed_.wait_until(lock, publisher_->next_time(), [&] { return has_news(); })) return;
            begin(Doing::working);
            lock.unlock();
            publish_if_wanted();
            lock.lock();
        }
    }

    void publish_if_wanted() {
        if (!publisher_->is_wanted() || Clock::now() < publisher_->next_time()) return;
        publisher_->publish([this](std::uint64_t pair_limit) { return scene_->snapshot(pair_limit); });
    }

    void step() {
        {
            const std::lock_guard lock(mutex_);
            begin(Doing::stepping);
        }
        const StepResult& result = scene_->step(stop_.get_token());
        {
            const std::lock_guard lock(mutex_);
            begin(Doing::working);
        }
        publisher_->note_step(scene_->numbers());
        answer(result);
        publish_if_wanted();
    }

    void answer(const StepResult& result) {
        const Bytes began = std::as_bytes(result.began), ended = std::as_bytes(result.ended);
        const std::size_t all = began.size() + ended.size();
        v1::SceneDownload small;
        small.set_step(scene_->numbers().step);
        for (std::size_t sent = 0; sent < all || !small.has_result();) {
            const grpc::Slice piece = piece_of(began, ended, sent);
            sent += piece.size();
            if (sent == all) {
                v1::SceneStep& step_result = *small.mutable_result();
                step_result.set_began(result.began.size());
                step_result.set_ended(result.ended.size());
                step_result.set_persisting(result.persisting);
                step_result.set_full(result.full);
                step_result.set_seconds(result.seconds);
            }
            write(pack(small, piece));
        }
    }

    void write(const grpc::ByteBuffer& message) {
        out_ = message;  // shares the bytes
        {
            const std::lock_guard lock(mutex_);
            begin(Doing::writing);
        }
        server_.server_log.sent(out_.Length());
        StartWrite(&out_);
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return doing_ != Doing::writing; });
        if (broken_) throw Error(ErrorCode::cancelled, "the client does not read");
    }

    /// Requires: mutex_ is locked.
    void begin(Doing doing) {
        doing_ = doing;
        since_ = Clock::now();
    }

    template <typename Change>
    void set(Change&& change) {
        const std::lock_guard lock(mutex_);
        change();
        changed_.notify_all();
    }

    void end_by(const grpc::Status& status) {
        set([&] {
            if (!refusal_) refusal_ = status;
        });
        stop_.request_stop();
    }

    /// Returns whether the current activity has taken too long, or must end because the server shuts down. Requires: mutex_ is
    /// locked.
    bool is_late(Clock::time_point now) const {
        const auto took = now - since_;
        const double max_seconds = server_.options.limits.job_seconds;
        switch (doing_) {
            case Doing::working:
                return false;
            case Doing::idle:
                return server_.draining;
            case Doing::waiting:
            case Doing::writing:
                return took > server_.options.stall;
            case Doing::stepping:
                return max_seconds > 0 && std::chrono::duration<double>(took).count() > max_seconds;
        }
        return false;
    }

    grpc::Status refused(const LimitError& error) {
        server_.server_log.limit_refused(admission_.client(), error);
        return status_of(error);
    }

    grpc::Status stalled() {
        const auto seconds = std::uint64_t(server_.options.stall.count());
        return refused(LimitError(
            "stall_seconds", seconds,
            "stall_seconds: nothing was received for " + std::to_string(seconds) + " s in the middle of a frame"));
    }

    grpc::Status stepped_too_long() { return refused(ran_too_long("the step", server_.options.limits.job_seconds)); }

    ServerContext& server_;
    grpc::CallbackServerContext& context_;
    std::shared_ptr<SceneCall> self_;  // keeps the object alive until OnDone
    Admission admission_;
    Budget::Reservation slot_;
    std::stop_source stop_;
    // Used by the call's thread; gRPC fills in_ during a read.
    grpc::ByteBuffer in_, message_, out_;
    UploadedCalls calls_;
    std::optional<ServerScene> scene_;
    std::shared_ptr<ScenePublisher> publisher_;  // set together with scene_
    bool in_frame_ = true;  // a part of the next frame was received, or the scene's options are missing

    std::mutex mutex_;
    std::condition_variable changed_;
    Read read_ = Read::none;
    Doing doing_ = Doing::working;
    Clock::time_point since_;
    bool broken_ = false;
    std::optional<grpc::Status> refusal_;
};

}  // namespace

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_scene(ServerContext& server,
                                                                         grpc::CallbackServerContext& context) {
    const auto call = std::make_shared<SceneCall>(server, context);
    call->start();
    return call.get();
}

}  // namespace octopair::service
