// JobClient: calls of a client for detached jobs. Every call is retried until the server answers or the timeout passes.

#include "octopair/job_client.hpp"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/floating_point_scope.hpp"
#include "engine/pair_list.hpp"
#include "engine/request.hpp"
#include "service/client/connection.hpp"
#include "service/client/raw_stream.hpp"
#include "service/client/received.hpp"
#include "service/client/uploader.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.grpc.pb.h"
#include "service/protocol/status.hpp"

namespace octopair {

namespace {

JobState state_of(v1::JobState state) {
    switch (state) {
        case v1::RUNNING:
            return JobState::running;
        case v1::DONE:
            return JobState::done;
        case v1::FAILED:
            return JobState::failed;
        case v1::CANCELLED:
            return JobState::cancelled;
        default:
            return JobState::queued;
    }
}

JobStatus status_of(const v1::JobReport& report) {
    JobStatus status;
    status.id = report.id();
    status.state = state_of(report.state());
    status.detached = report.detached();
    status.count_only = report.count_only();
    status.progress = report.progress();
    status.queued_before = report.queued_before();
    status.objects = report.objects();
    status.owner = report.owner();
    status.waits_for_room = report.waits_for_room();
    if (report.has_summary()) status.summary = service::summary_of(report.summary());
    if (!report.has_failure()) return status;
    try {
        service::throw_failure(report.failure());
    } catch (const Error& error) {
        status.error = error;
    }
    return status;
}

}  // namespace

class JobClient::State {
public:
    State(std::string_view address, const ClientOptions& options)
        : owner_(options.owner), connection_(address, options), calls_(v1::Octopair::NewStub(connection_.channel())) {}

    v1::JobName name_of(const std::string& id) const {
        v1::JobName name;
        name.set_id(id);
        name.set_owner(owner_);
        return name;
    }
    const std::string& owner() const { return owner_; }

    /// Makes a unary call, with retries. call(context, stub) makes one attempt and returns its status.
    template <typename Call>
    void ask(const std::stop_token& stop, Call&& call) {
        connection_.call_with_retries(stop, [&] {
            grpc::ClientContext context;
            connection_.prepare(context);
            const std::stop_callback cancel(stop, [&] { context.TryCancel(); });
            return call(context, *calls_);
        });
    }

    bool has_job(const std::string& id, const std::stop_token& stop) {
        v1::JobReport report;
        try {
            ask(stop, [&](auto& context, auto& calls) { return calls.Status(&context, name_of(id), &report); });
        } catch (const Error& error) {
            if (error.code() == ErrorCode::bad_input) return false;
            throw;
        }
        return true;
    }

    std::string submit(const detail::Request& request, const JobTerms& terms, const std::stop_token& stop) {
        detail::check_request(request);
        if (request.options.verify) {
            throw Error(ErrorCode::usage, "verify: a detached job cannot be verified; use Engine::submit instead");
        }
        v1::JobSpec spec = service::spec_of(request, !terms.count_only);
        spec.set_id(terms.id.empty() ? service::new_id() : terms.id);
        service::check_id(spec.id());
        service::Uploader upload(std::move(spec), service::arrays_of(request));
        v1::JobReport report;
        const auto next = [&]() -> std::optional<grpc::ByteBuffer> {
            if (upload.done()) return {};
            grpc::ByteBuffer message = upload.next();
            if (request.options.progress) request.options.progress(upload.progress());
            return message;
        };
        const auto take = [&](grpc::ByteBuffer& message) {
            if (!service::unpack(message, report)) {
                throw Error(ErrorCode::engine_failed,
                            connection_.server() + ": the answer is not a valid message of octopair's protocol");
            }
        };
        connection_.call_with_retries(stop, [&] {
            upload.restart(0);
            return service::RawStream(connection_, {"/octopair.v1.Octopair/Submit", next, take}).run(stop);
        });
        return report.id();
    }

    Summary result(const std::string& id, const detail::Output& output, const detail::Control& control) {
        service::Received received(connection_.server(), output, control);
        const auto take = [&](grpc::ByteBuffer& message) { received.take(message); };
        connection_.call_with_retries(control.stop, [&] {
            received.begin_attempt();
            bool asked = false;
            const auto next = [&]() -> std::optional<grpc::ByteBuffer> {
                if (std::exchange(asked, true)) return {};
                v1::ResultRequest request;
                request.set_id(id);
                request.set_offset(received.pairs());
                request.set_hash(received.hash());
                return service::pack(request);
            };
            return service::RawStream(connection_, {"/octopair.v1.Octopair/Result", next, take}).run(control.stop);
        });
        return received.finish();
    }

private:
    const std::string owner_;
    service::Connection connection_;
    std::unique_ptr<v1::Octopair::Stub> calls_;
};

JobClient::JobClient(std::string_view address, const ClientOptions& options)
    : state_(std::make_unique<State>(address, options)) {}

JobClient::~JobClient() = default;

std::string JobClient::submit(const Input& input, const Options& options, const JobTerms& terms, std::stop_token stop) {
    const FloatingPointScope scope;
    return state_->submit(detail::request_of(input, options), terms, stop);
}

JobStatus JobClient::status(const std::string& id, std::stop_token stop) {
    v1::JobReport report;
    state_->ask(stop, [&](auto& context, auto& calls) { return calls.Status(&context, state_->name_of(id), &report); });
    return status_of(report);
}

JobStatus JobClient::wait(const std::string& id, std::chrono::duration<double> most, std::stop_token stop) {
    using Clock = std::chrono::steady_clock;
    constexpr double at_once = 60;  // seconds for one call, because proxies may end calls that are silent for longer
    const auto begun = Clock::now();
    v1::JobReport report;
    for (;;) {
        const double left = std::max(0.0, most.count() - std::chrono::duration<double>(Clock::now() - begun).count());
        v1::WaitRequest request;
        request.set_id(id);
        request.set_owner(state_->owner());
        request.set_seconds(std::min(left, at_once));
        state_->ask(stop, [&](auto& context, auto& calls) { return calls.Wait(&context, request, &report); });
        JobStatus status = status_of(report);
        if (status.ended() || left <= at_once) return status;
    }
}

JobStatus JobClient::cancel(const std::string& id, std::stop_token stop) {
    v1::JobReport report;
    state_->ask(stop, [&](auto& context, auto& calls) { return calls.Cancel(&context, state_->name_of(id), &report); });
    return status_of(report);
}

void JobClient::release(const std::string& id, std::stop_token stop) {
    v1::JobReport report;
    int attempts = 0;
    try {
        state_->ask(stop, [&](auto& context, auto& calls) {
            ++attempts;
            return calls.Release(&context, state_->name_of(id), &report);
        });
    } catch (const service::NoJobError&) {
        // An earlier attempt whose answer was lost may have released the job.
        if (attempts == 1) throw;
    } catch (const Error& error) {
        // A server of an older version has no error of its own for an unknown job: release and status of such a job both give bad_input.
        if (attempts == 1 || error.code() != ErrorCode::bad_input || state_->has_job(id, stop)) throw;
    }
}

std::vector<JobStatus> JobClient::list(std::stop_token stop) {
    std::vector<JobStatus> jobs;
    v1::ListRequest request;
    v1::JobList list;
    do {
        state_->ask(stop, [&](auto& context, auto& calls) { return calls.List(&context, request, &list); });
        for (const v1::JobReport& report : list.jobs()) jobs.push_back(status_of(report));
        if (list.jobs_size() > 0) {
            request.set_after(list.jobs().rbegin()->id());
            request.set_after_owner(list.jobs().rbegin()->owner());
        }
    } while (list.more() && list.jobs_size() > 0);
    return jobs;
}

void JobClient::drain(std::stop_token stop) {
    v1::DrainReport report;
    state_->ask(stop, [&](auto& context, auto& calls) { return calls.Drain(&context, v1::DrainRequest(), &report); });
}

Summary JobClient::result(const std::string& id, PairList& pairs, const ProgressSink& progress, std::stop_token stop) {
    detail::storage_of(pairs).reset();
    const detail::Output output = {.list = status(id, stop).count_only ? nullptr : &pairs};
    try {
        return state_->result(id, output, {stop, progress});
    } catch (...) {
        detail::storage_of(pairs).reset();
        throw;
    }
}

Summary JobClient::result(const std::string& id, const PairSink& sink, const ProgressSink& progress,
                          std::stop_token stop) {
    const detail::Output output = {.sink = status(id, stop).count_only || !sink ? nullptr : &sink};
    return state_->result(id, output, {stop, progress});
}

}  // namespace octopair
