// The call Submit: stores a detached job.
#include "service/server/calls/call_handlers.hpp"

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/calls/job_messages.hpp"
#include "service/server/server_context.hpp"
#include "service/server/store/detached_jobs.hpp"
#include "service/server/store/state_folder.hpp"

namespace octopair::service {

namespace {

using Clock = std::chrono::steady_clock;

/// The call Submit: reads the upload; then a task of the disk queue commits the job and answers. Only the first end() takes
/// effect.
class SubmitCall final : public grpc::ServerReadReactor<grpc::ByteBuffer>,
                         public Watched,
                         public std::enable_shared_from_this<SubmitCall> {
public:
    SubmitCall(ServerContext& server, const grpc::CallbackServerContext& context, grpc::ByteBuffer& response)
        : server_(server), context_(context), response_(response), upload_([this](v1::JobSpec spec) -> InputTarget& {
              submission_ = server_.detached->begin(admission_.client(), std::move(spec));
              return *submission_.upload;
          }) {}

    void start() {
        self_ = shared_from_this();
        const grpc::Status status = server_.admit(context_, Right::submit, admission_);
        if (!status.ok()) return end(status);
        if (!server_.detached) {
            return end(status_of(Error(ErrorCode::usage, "the server has no state folder: it takes no detached jobs")));
        }
        server_.watchdog.watch(self_);
        StartRead(&in_);
    }

    void OnReadDone(bool ok) override {
        try {
            if (!ok) {
                upload_.finish();
                return commit();
            }
            server_.server_log.received(in_.Length());
            upload_.take(in_);
        } catch (...) {
            return end(status_of_exception());
        }
        if (upload_.take_progress()) {
            const std::lock_guard lock(mutex_);
            last_progress_ = Clock::now();
        }
        StartRead(&in_);
    }

    void OnCancel() override { end_unless_committing({grpc::StatusCode::CANCELLED, "cancelled"}); }
    void OnDone() override { self_.reset(); }

    void check_deadline(Clock::time_point now) override {
        {
            const std::lock_guard lock(mutex_);
            if (ended_ || committing_ || now - last_progress_ < server_.options.stall) return;
        }
        end_unless_committing(server_.refuse_stalled(admission_.client()));
    }

private:
    void commit() {
        {
            const std::lock_guard lock(mutex_);
            if (ended_) return;
            committing_ = true;
        }
        server_.state->disk_queue().add([self = shared_from_this()] { self->commit_now(); });
    }

    void commit_now() {
        try {
            const auto job = server_.detached->commit(submission_);
            // The job existed at the start of this upload, so the upload was not stored. The job was released since: the client must retry.
            if (!job)
                return end({grpc::StatusCode::UNAVAILABLE, "the job was released during its upload; submit it again"});
            server_.server_log.job_submitted(*job, context_);
            response_ = pack(server_.report(*job, admission_.caller));
            server_.server_log.sent(response_.Length());
            end(grpc::Status::OK);
        } catch (...) {
            end(status_of_exception());
        }
    }

    void end_unless_committing(const grpc::Status& status) {
        {
            const std::lock_guard lock(mutex_);
            if (committing_) return;
        }
        end(status);
    }

    void end(const grpc::Status& status) {
        {
            const std::lock_guard lock(mutex_);
            if (std::exchange(ended_, true)) return;
        }
        if (!status.ok() && status.error_code() != grpc::StatusCode::RESOURCE_EXHAUSTED && admission_.call.amount() > 0)
            server_.server_log.call_failed({admission_.client(), context_.peer()}, status);
        Finish(status);
    }

    ServerContext& server_;
    const grpc::CallbackServerContext& context_;
    grpc::ByteBuffer& response_;
    std::shared_ptr<SubmitCall> self_;  // keeps the object alive until OnDone
    Admission admission_;
    // Used by the reading side, then by the task of the disk queue.
    grpc::ByteBuffer in_;
    Submission submission_;
    Upload upload_;

    std::mutex mutex_;
    Clock::time_point last_progress_ = Clock::now();  // time of the last progress of the upload
    bool committing_ = false;
    bool ended_ = false;
};

}  // namespace

grpc::ServerReadReactor<grpc::ByteBuffer>* start_submit(ServerContext& server, grpc::CallbackServerContext& context,
                                                        grpc::ByteBuffer& response) {
    const auto call = std::make_shared<SubmitCall>(server, context, response);
    call->start();
    return call.get();
}

}  // namespace octopair::service
