// The calls about existing jobs: Status, Wait, Cancel, Release, List.
#include "service/server/calls/call_handlers.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "octopair/error.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/server_context.hpp"
#include "service/server/store/detached_jobs.hpp"
#include "service/server/store/state_folder.hpp"

namespace octopair::service {

namespace {

using Clock = std::chrono::steady_clock;

/// Calls `answer` with the caller's name, and finishes the call. An exception of `answer` becomes the status of the call.
template <typename Answer>
grpc::ServerUnaryReactor* answer_at_once(ServerContext& server, grpc::CallbackServerContext& context, Answer&& answer) {
    grpc::ServerUnaryReactor* const reactor = context.DefaultReactor();
    std::string owner;
    grpc::Status status = server.admit(context, owner);
    try {
        if (status.ok()) answer(owner);
    } catch (...) {
        status = status_of_exception();
    }
    reactor->Finish(status);
    return reactor;
}

/// The calls Wait and Cancel: answer when the job has ended or the time is over. They fail when the server shuts down.
class WaitCall final : public grpc::ServerUnaryReactor,
                       public JobWatcher,
                       public Watched,
                       public std::enable_shared_from_this<WaitCall> {
public:
    WaitCall(ServerContext& server, v1::JobReport& response) : server_(server), response_(response) {}

    struct Terms {
        std::string id;
        double seconds = 0;
        bool cancel = false;
    };

    void start(const grpc::CallbackServerContext& context, const Terms& terms) {
        self_ = shared_from_this();
        std::string owner;
        const grpc::Status status = server_.admit(context, owner);
        if (!status.ok()) return end(status);
        try {
            job_ = server_.jobs.find(owner, terms.id);
        } catch (...) {
            return end(status_of_exception());
        }
        constexpr double hour = 3600;
        const double seconds = terms.seconds > 0 ? std::min(terms.seconds, hour) : 0;
        until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
        job_->watch(self_);
        if (terms.cancel) job_->cancel();
        server_.watchdog.watch(self_);
        if (seconds == 0) return answer();
        job_changed();
    }

    void job_changed() override {
        if (job_->ended()) answer();
    }

    void check_deadline(Clock::time_point now) override {
        if (now >= until_) return answer();
        if (server_.draining) end({grpc::StatusCode::UNAVAILABLE, "the server is going down"});
    }

    void OnCancel() override { end({grpc::StatusCode::CANCELLED, "cancelled"}); }
    void OnDone() override { self_.reset(); }

private:
    bool is_first() {
        const std::lock_guard lock(mutex_);
        return !std::exchange(ended_, true);
    }

    void answer() {
        if (!is_first()) return;
        response_ = server_.report(*job_);
        Finish(grpc::Status::OK);
    }

    void end(const grpc::Status& status) {
        if (is_first()) Finish(status);
    }

    ServerContext& server_;
    v1::JobReport& response_;
    std::shared_ptr<WaitCall> self_;  // keeps the object alive until OnDone
    std::shared_ptr<ServerJob> job_;
    Clock::time_point until_{};
    std::mutex mutex_;
    bool ended_ = false;
};

}  // namespace

grpc::ServerUnaryReactor* start_status(ServerContext& server, grpc::CallbackServerContext& context,
                                       const v1::JobName& request, v1::JobReport& response) {
    return answer_at_once(server, context, [&](const std::string& owner) {
        response = server.report(*server.jobs.find(owner, request.id()));
    });
}

grpc::ServerUnaryReactor* start_wait(ServerContext& server, grpc::CallbackServerContext& context,
                                     const v1::WaitRequest& request, v1::JobReport& response) {
    const auto call = std::make_shared<WaitCall>(server, response);
    call->start(context, {request.id(), request.seconds()});
    return call.get();
}

grpc::ServerUnaryReactor* start_cancel(ServerContext& server, grpc::CallbackServerContext& context,
                                       const v1::JobName& request, v1::JobReport& response) {
    constexpr double seconds = 10;
    const auto call = std::make_shared<WaitCall>(server, response);
    call->start(context, {request.id(), seconds, true});
    return call.get();
}

grpc::ServerUnaryReactor* start_release(ServerContext& server, grpc::CallbackServerContext& context,
                                        const v1::JobName& request, v1::JobReport& response) {
    grpc::ServerUnaryReactor* const reactor = context.DefaultReactor();
    std::string owner;
    const grpc::Status status = server.admit(context, owner);
    std::shared_ptr<ServerJob> job;
    try {
        if (status.ok()) job = server.jobs.find(owner, request.id());
        if (job && !job->detached()) throw Error(ErrorCode::bad_input, "job " + request.id() + " is not detached");
        if (job && !job->ended()) throw Error(ErrorCode::bad_input, "job " + request.id() + " has not ended");
    } catch (...) {
        reactor->Finish(status_of_exception());
        return reactor;
    }
    if (!job) {
        reactor->Finish(status);
        return reactor;
    }
    server.state->disk_queue().add([&server, &response, job, reactor] {
        response = server.report(*job);
        server.detached->release(*job);
        reactor->Finish(grpc::Status::OK);
    });
    return reactor;
}

grpc::ServerUnaryReactor* start_list(ServerContext& server, grpc::CallbackServerContext& context,
                                     const v1::ListRequest& request, v1::JobList& response) {
    constexpr std::size_t most = 1000;  // reports of so many jobs fit into one message
    return answer_at_once(server, context, [&](const std::string& owner) {
        auto jobs = server.jobs.of(owner, request.after(), most + 1);
        response.set_more(jobs.size() > most);
        jobs.resize(std::min(jobs.size(), most));
        for (const auto& job : jobs) *response.add_jobs() = server.report(*job);
    });
}

}  // namespace octopair::service
