// The calls about existing jobs, Status, Wait, Cancel, Release and List, and those about the server, Describe and Drain.
#include "service/server/calls/call_handlers.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "octopair/error.hpp"
#include "octopair/version.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/calls/unary_call.hpp"
#include "service/server/server_context.hpp"
#include "service/server/store/detached_jobs.hpp"
#include "service/server/store/state_folder.hpp"

namespace octopair::service {

namespace {

using Clock = std::chrono::steady_clock;

/// The calls Wait and Cancel: answer when the job has ended or the time is over. They fail when the server shuts down.
class WaitCall final : public grpc::ServerUnaryReactor,
                       public JobWatcher,
                       public Watched,
                       public std::enable_shared_from_this<WaitCall> {
public:
    WaitCall(ServerContext& server, grpc::ByteBuffer& response) : server_(server), response_(response) {}

    /// `read` returns the request. It may throw.
    template <typename Read>
    void start(const grpc::CallbackServerContext& context, Right right, Read&& read) {
        self_ = shared_from_this();
        const grpc::Status status = server_.admit(context, right, admission_);
        if (!status.ok()) return end(status);
        try {
            const v1::WaitRequest asked = read();
            job_ = server_.find(admission_.caller, asked.owner(), asked.id());
            if (right == Right::cancel)
                server_.server_log.job_asked("cancel", *job_, {admission_.client(), context.peer()});
            start_waiting(asked.seconds(), right == Right::cancel);
        } catch (...) {
            end(status_of_exception());
        }
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
    void start_waiting(double asked_seconds, bool cancel) {
        constexpr double hour = 3600;
        const double seconds = asked_seconds > 0 ? std::min(asked_seconds, hour) : 0;
        until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
        job_->watch(self_);
        if (cancel) job_->cancel();
        server_.watchdog.watch(self_);
        if (seconds == 0) return answer();
        job_changed();
    }

    bool is_first() {
        const std::lock_guard lock(mutex_);
        return !std::exchange(ended_, true);
    }

    void answer() {
        if (!is_first()) return;
        response_ = pack(server_.report(*job_, admission_.caller));
        Finish(grpc::Status::OK);
    }

    void end(const grpc::Status& status) {
        if (is_first()) Finish(status);
    }

    ServerContext& server_;
    grpc::ByteBuffer& response_;
    Admission admission_;
    std::shared_ptr<WaitCall> self_;  // keeps the object alive until OnDone
    std::shared_ptr<ServerJob> job_;
    Clock::time_point until_{};
    std::mutex mutex_;
    bool ended_ = false;
};

v1::ServerDescription describe(const ServerContext& server) {
    const ServerLimits& limits = server.options.limits;
    v1::ServerDescription description;
    description.set_version(OCTOPAIR_VERSION);
    description.set_algorithm(algorithm_version);
    description.set_engine(server.options.engine_name);
    description.set_detached(!server.options.state_folder.empty());
    v1::Limits& described = *description.mutable_limits();
    described.set_objects(limits.objects);
    described.set_input_bytes(limits.input_bytes);
    described.set_pairs(limits.pairs);
    described.set_jobs(limits.jobs);
    described.set_jobs_per_client(limits.jobs_per_client);
    described.set_connections(limits.connections);
    described.set_connections_per_client(server.connections_per_client);
    described.set_calls_per_client(server.calls.each());
    described.set_job_seconds(limits.job_seconds);
    described.set_memory_bytes(limits.memory_bytes);
    described.set_memory_bytes_per_client(server.memory.each());
    described.set_state_bytes(limits.state_bytes);
    if (server.state) described.set_state_bytes_per_client(server.state->disk().each());
    described.set_message_bytes(max_message_bytes);
    return description;
}

/// Throws: Error{bad_input} if the caller has no such job, or if it cannot be released.
std::shared_ptr<ServerJob> releasable(const ServerContext& server, const Caller& caller, const std::string& id) {
    std::shared_ptr<ServerJob> job = server.find(caller, {}, id);
    if (!job->detached()) throw Error(ErrorCode::bad_input, "job " + id + " is not detached");
    if (!job->ended()) throw Error(ErrorCode::bad_input, "job " + id + " has not ended");
    return job;
}

v1::JobList list(const ServerContext& server, const Caller& caller, const v1::ListRequest& asked) {
    constexpr std::size_t most = 1000;  // jobs per answer; 1000 reports fit into one message
    auto jobs = caller.sees_all() ? server.jobs.of_all(asked.after_owner(), asked.after(), most + 1)
                                  : server.jobs.of(caller.owner(), asked.after(), most + 1);
    v1::JobList list;
    list.set_more(jobs.size() > most);
    jobs.resize(std::min(jobs.size(), most));
    for (const auto& job : jobs) *list.add_jobs() = server.report(*job, caller);
    return list;
}

}  // namespace

grpc::ServerUnaryReactor* start_describe(ServerContext& server, grpc::CallbackServerContext& context,
                                         const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    return answer_at_once<v1::DescribeRequest>(
        {server, context, request, response}, Right::describe,
        [&](const Caller&, const v1::DescribeRequest&) { return describe(server); });
}

grpc::ServerUnaryReactor* start_status(ServerContext& server, grpc::CallbackServerContext& context,
                                       const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    return answer_at_once<v1::JobName>({server, context, request, response}, Right::see,
                                       [&](const Caller& caller, const v1::JobName& name) {
                                           return server.report(*server.find(caller, name.owner(), name.id()), caller);
                                       });
}

grpc::ServerUnaryReactor* start_wait(ServerContext& server, grpc::CallbackServerContext& context,
                                     const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    const auto call = std::make_shared<WaitCall>(server, response);
    call->start(context, Right::see, [&] { return parsed<v1::WaitRequest>(request); });
    return call.get();
}

grpc::ServerUnaryReactor* start_cancel(ServerContext& server, grpc::CallbackServerContext& context,
                                       const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    constexpr double seconds = 10;
    const auto call = std::make_shared<WaitCall>(server, response);
    call->start(context, Right::cancel, [&] {
        const auto name = parsed<v1::JobName>(request);
        v1::WaitRequest wanted;
        wanted.set_id(name.id());
        wanted.set_owner(name.owner());
        wanted.set_seconds(seconds);
        return wanted;
    });
    return call.get();
}

grpc::ServerUnaryReactor* start_release(ServerContext& server, grpc::CallbackServerContext& context,
                                        const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    grpc::ServerUnaryReactor* const reactor = context.DefaultReactor();
    auto admission = std::make_shared<Admission>();
    const grpc::Status status = server.admit(context, Right::release, *admission);
    std::shared_ptr<ServerJob> job;
    try {
        if (status.ok()) job = releasable(server, admission->caller, parsed<v1::JobName>(request).id());
    } catch (...) {
        reactor->Finish(status_of_exception());
        return reactor;
    }
    if (!job) {
        reactor->Finish(status);
        return reactor;
    }
    server.server_log.job_asked("release", *job, {admission->client(), context.peer()});
    server.state->disk_queue().add([&server, &response, admission, job, reactor] {
        response = pack(server.report(*job, admission->caller));
        server.detached->release(*job);
        reactor->Finish(grpc::Status::OK);
    });
    return reactor;
}

grpc::ServerUnaryReactor* start_list(ServerContext& server, grpc::CallbackServerContext& context,
                                     const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    return answer_at_once<v1::ListRequest>(
        {server, context, request, response}, Right::see,
        [&](const Caller& caller, const v1::ListRequest& asked) { return list(server, caller, asked); });
}

grpc::ServerUnaryReactor* start_drain(ServerContext& server, grpc::CallbackServerContext& context,
                                      const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    return answer_at_once<v1::DrainRequest>({server, context, request, response}, Right::drain,
                                            [&](const Caller& caller, const v1::DrainRequest&) {
                                                if (!server.options.on_drain)
                                                    throw Error(ErrorCode::usage, "this server ends only by a signal");
                                                server.server_log.drain_asked({caller.name, context.peer()});
                                                server.options.on_drain();
                                                return v1::DrainReport();
                                            });
}

}  // namespace octopair::service
