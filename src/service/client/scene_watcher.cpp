// SceneWatcher: the calls of a client about running scenes. Every call is retried until the server answers or the timeout passes.

#include "octopair/scene_watcher.hpp"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <utility>

#include "octopair/error.hpp"
#include "service/client/connection.hpp"
#include "service/client/raw_stream.hpp"
#include "service/client/received_snapshot.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.grpc.pb.h"

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
