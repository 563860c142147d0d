// RemoteScene: a scene whose objects are kept by the client, and whose pairs are found by the server.
#include "octopair/remote_scene.hpp"

#include <chrono>
#include <cstring>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/floating_point_scope.hpp"
#include "base/stop.hpp"
#include "engine/pair_list.hpp"
#include "scene/pair_history.hpp"
#include "scene/scene_objects.hpp"
#include "service/client/connection.hpp"
#include "service/client/pending_calls.hpp"
#include "service/client/scene_stream.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"

namespace octopair {

namespace {

using service::SceneStream;

/// Returns whether pairs are valid: ascending, with a < b < indices.
bool are_pairs(std::span<const Pair> pairs, std::uint64_t indices) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Pair& pair = pairs[i];
        if (pair.a >= pair.b || pair.b >= indices) return false;
        if (i > 0 && !(key_of(pairs[i - 1]) < key_of(pair))) return false;
    }
    return true;
}

}  // namespace

/// Invariant: while there is a stream, the server has the scene of the last step, and `calls_` holds the calls since then.
class RemoteScene::State {
public:
    State(std::string_view address, const RemoteSceneOptions& options, const ClientOptions& client)
        : options_{1, options.precision, options.margin},
          objects_(options_, SceneObjects::Changes::forgotten),
          connection_(address, client) {
        connection_.check_server();
    }

    SceneObjects& objects() { return objects_; }
    const StepResult& step(const std::stop_token& stop);
    const PairList& pairs() { return history_.list(); }
    const PairList& persisting() {
        subtract(history_.list(), changes_.began, persisting_);
        return persisting_;
    }

private:
    /// Result of a step from the server.
    struct Answer {
        std::vector<Pair> pairs;  // pairs that began, then pairs that ended
        v1::SceneStep told;
    };

    grpc::Status ask(const std::stop_token& stop);
    bool exchange(const std::stop_token& stop);
    void receive();
    bool fits(const Answer& answer) const;
    void take();
    void forget_stream();

    const SceneOptions options_;
    SceneObjects objects_;
    service::PendingCalls calls_;
    service::Connection connection_;
    std::optional<SceneStream> stream_;
    bool whole_ = false;  // the current step is the first step of its stream, so the client sends the whole scene
    Answer answer_;

    PairHistory history_;
    PairChanges changes_;  // changes of the last step
    PairChanges found_;    // changes of the current step; swapped into changes_ when the step has succeeded
    PairList persisting_;
    StepResult result_;
};

const StepResult& RemoteScene::State::step(const std::stop_token& stop) {
    throw_if_stopped(stop);
    const auto begin = std::chrono::steady_clock::now();
    const std::uint64_t before = history_.size();
    try {
        connection_.call_with_retries(stop, [&] { return ask(stop); });
        history_.prepare(!whole_);
        take();
        std::swap(changes_, found_);
    } catch (const std::bad_alloc&) {
        forget_stream();
        throw Error(ErrorCode::resource_limit, "out of memory");
    } catch (...) {
        forget_stream();
        throw;
    }
    objects_.finish_step();
    objects_.record_to(&calls_);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    result_ = {changes_.began, changes_.ended, before - changes_.ended.size(), answer_.told.full(), took.count()};
    return result_;
}

/// Makes one attempt of a step: sends the changes, or the whole scene on a new stream if there is none.
grpc::Status RemoteScene::State::ask(const std::stop_token& stop) {
    whole_ = !stream_;
    if (whole_) stream_.emplace(connection_);
    if (exchange(stop)) return grpc::Status::OK;
    const grpc::Status status = stream_->status();
    forget_stream();
    // A server that shuts down cancels its calls, or ends them with status OK. In both cases the step has no result, so it is retried.
    const bool away = status.ok() || status.error_code() == grpc::StatusCode::CANCELLED;
    return away ? grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server ended the scene") : status;
}

/// Sends the calls and receives the result of a step. Returns false if the server ended the call.
bool RemoteScene::State::exchange(const std::stop_token& stop) {
    const std::stop_callback cancel(stop, [&] { stream_->cancel(); });
    const auto send = [&](Bytes piece) { stream_->send(piece); };
    try {
        if (whole_) calls_.send_whole(options_, objects_, send);
        calls_.step();
        calls_.send(send);
        receive();
        return true;
    } catch (const SceneStream::Ended&) {
        return false;
    }
}

void RemoteScene::State::receive() {
    answer_.pairs.clear();
    for (answer_.told.Clear();;) {
        grpc::ByteBuffer message = stream_->receive();
        connection_.heard();
        v1::SceneDownload small;
        std::size_t at = answer_.pairs.size() * sizeof(Pair), end = at + message.Length();
        answer_.pairs.resize((end + sizeof(Pair) - 1) / sizeof(Pair));
        const bool right = service::unpack(message, small, [&](Bytes piece) {
            std::memcpy(reinterpret_cast<std::byte*>(answer_.pairs.data()) + at, piece.data(), piece.size());
            at += piece.size();
        });
        answer_.pairs.resize(at / sizeof(Pair));
        const bool whole_pairs = at % sizeof(Pair) == 0;
        if (small.has_result()) answer_.told = std::move(*small.mutable_result());
        if (right && whole_pairs && !small.has_result()) continue;
        if (right && whole_pairs && fits(answer_)) return;
        throw Error(ErrorCode::engine_failed,
                    connection_.server() + ": the answer is not a valid message of octopair's protocol");
    }
}

bool RemoteScene::State::fits(const Answer& answer) const {
    const std::uint64_t began = answer.told.began(), ended = answer.told.ended(), all = answer.pairs.size();
    const std::uint64_t before = whole_ ? 0 : history_.size(), indices = objects_.table().indices();
    const std::span<const Pair> pairs = answer.pairs;
    return began <= all && ended == all - began && ended <= before && answer.told.persisting() == before - ended &&
           are_pairs(pairs.first(std::size_t(began)), indices) && are_pairs(pairs.subspan(std::size_t(began)), indices);
}

/// Stores the pairs of the answer in the history. A new scene on the server reports all pairs as begun; the client then finds
/// the changes by comparison.
void RemoteScene::State::take() {
    const auto ended = answer_.pairs.begin() + std::ptrdiff_t(answer_.told.began());
    if (!whole_) {
        found_.began.reserve(std::size_t(answer_.told.began()));
        found_.ended.reserve(std::size_t(answer_.told.ended()));
        found_.began.assign(answer_.pairs.begin(), ended);
        found_.ended.assign(ended, answer_.pairs.end());
        history_.apply(found_);
        return;
    }
    detail::PairStorage& fresh = detail::storage_of(history_.fresh());
    fresh.reset();
    fresh.append(fresh.copy(answer_.pairs));
    history_.take_over(found_);
}

void RemoteScene::State::forget_stream() {
    stream_.reset();
    calls_.clear();
    objects_.record_to(nullptr);
}

RemoteScene::RemoteScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RemoteScene::RemoteScene(RemoteScene&&) noexcept = default;
RemoteScene& RemoteScene::operator=(RemoteScene&&) noexcept = default;
RemoteScene::~RemoteScene() = default;

void RemoteScene::add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits) {
    const FloatingPointScope scope;
    state_->objects().add(objects, ids, traits);
}

void RemoteScene::move(std::span<const ObjectId> ids, const Boxes& boxes) {
    const FloatingPointScope scope;
    state_->objects().move(ids, boxes, false);
}

void RemoteScene::sweep(std::span<const ObjectId> ids, const Boxes& boxes) {
    const FloatingPointScope scope;
    state_->objects().move(ids, boxes, true);
}

void RemoteScene::remove(std::span<const ObjectId> ids) {
    const FloatingPointScope scope;
    state_->objects().remove(ids);
}

void RemoteScene::set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
    const FloatingPointScope scope;
    state_->objects().set_traits(ids, traits);
}

const StepResult& RemoteScene::step(std::stop_token stop) {
    const FloatingPointScope scope;
    return state_->step(stop);
}

const PairList& RemoteScene::pairs() {
    const FloatingPointScope scope;
    return state_->pairs();
}

const PairList& RemoteScene::persisting() {
    const FloatingPointScope scope;
    return state_->persisting();
}

std::uint64_t RemoteScene::size() const { return state_->objects().table().size(); }
std::uint64_t RemoteScene::indices() const { return state_->objects().table().indices(); }
bool RemoteScene::contains(ObjectId id) const { return state_->objects().table().contains(id); }
ObjectId RemoteScene::id(std::uint32_t index) const { return state_->objects().id(index); }

RemoteScene connect_scene(std::string_view address, const RemoteSceneOptions& options, const ClientOptions& client) {
    const FloatingPointScope scope;
    return RemoteScene(std::make_unique<RemoteScene::State>(address, options, client));
}

}  // namespace octopair
