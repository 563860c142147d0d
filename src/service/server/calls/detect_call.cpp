// The calls Detect and DetectSmall: run one attached job.
#include "service/server/calls/call_handlers.hpp"

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "service/protocol/errors.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/calls/download_call.hpp"
#include "service/server/calls/job_messages.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

namespace {

/// The call Detect: reads the upload, queues the job, and sends its pairs while they are found.
class DetectCall final : public DownloadCall<grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>>,
                         public std::enable_shared_from_this<DetectCall> {
public:
    DetectCall(ServerContext& server, grpc::CallbackServerContext& context)
        : DownloadCall(server, context), upload_([this](v1::JobSpec spec) -> InputTarget& {
              check_id(spec.id());
              const auto job = this->server().begin(caller().name, std::move(spec));
              const std::lock_guard lock(job_mutex_);
              job_ = job;
              return job->input();
          }) {}

    void start() {
        if (begin(shared_from_this(), Right::submit)) StartRead(&in_);
    }

    void OnReadDone(bool ok) override {
        const std::size_t bytes = in_.Length();
        try {
            if (!ok) return upload_.finish();
            read();
        } catch (...) {
            refuse(status_of_exception());
            ok = false;
        }
        // Counted after the message had its effect, so that who sees the count finds the call refused.
        server().server_log.received(bytes);
        if (ok) StartRead(&in_);
    }

private:
    void read() {
        upload_.take(in_);
        if (upload_.complete() && !queued_) queue();
        if (upload_.take_progress()) note_progress();
    }

    void queue() {
        queued_ = true;
        attached_ = server().attached.take(1);
        const std::shared_ptr<ServerJob> job = this->job();
        job->queue();
        // A client may reconnect before the server notices that the old connection broke. The old job with this id is then still in the
        // table.
        for (auto before = server().jobs.enter(job); before != job; before = server().jobs.enter(job)) {
            before->cancel();
            server().jobs.remove(*before);
        }
        server().server_log.job_submitted(*job, context());
        send(job, job->spec().offset());
        server().queue(job);
    }

    void refused() override {
        if (const auto job = this->job()) job->cancel();
    }

    void done() override {
        if (const auto job = this->job()) {
            job->cancel();
            server().jobs.remove(*job);
        }
    }

    void handle_stall(bool downloading) override {
        if (!downloading) refuse(server().refuse_stalled(caller().name));
    }

    std::shared_ptr<ServerJob> job() const {
        const std::lock_guard lock(job_mutex_);
        return job_;
    }

    // Used by the reading side only.
    grpc::ByteBuffer in_;
    Upload upload_;
    bool queued_ = false;
    Budget::Reservation attached_;

    mutable std::mutex job_mutex_;
    std::shared_ptr<ServerJob> job_;  // null before the first message
};

/// The call DetectSmall: answers when the job has ended.
class SmallCall final : public grpc::ServerUnaryReactor,
                        public JobWatcher,
                        public std::enable_shared_from_this<SmallCall> {
public:
    SmallCall(ServerContext& server, grpc::CallbackServerContext& context, grpc::ByteBuffer& response)
        : server_(server), context_(context), response_(response) {}

    void start(grpc::ByteBuffer request) {
        self_ = shared_from_this();
        const grpc::Status status = server_.admit(context_, Right::submit, admission_);
        if (!status.ok()) return answer({}, status);
        server_.server_log.received(request.Length());
        Upload upload([&](v1::JobSpec spec) -> InputTarget& {
            if (!spec.id().empty()) check_id(spec.id());
            job_ = server_.begin(admission_.client(), std::move(spec));
            return job_->input();
        });
        try {
            upload.take(request);
            upload.finish();
            attached_ = server_.attached.take(1);
            job_->queue();
            job_->watch(self_);
            server_.server_log.job_submitted(*job_, context_);
            server_.queue(job_);
        } catch (...) {
            if (job_) job_->cancel();
            answer({}, status_of_exception());
        }
    }

    void OnCancel() override {
        if (job_) job_->cancel();
    }
    void OnDone() override { self_.reset(); }

    void job_changed() override {
        if (!job_->ended()) {
            if (job_->pairs().ready() <= piece_bytes / sizeof(Pair)) return;
            answer({}, too_large());
            return job_->cancel();
        }
        Download::Next next = Download(job_, job_->spec().offset()).next();
        if (next.kind == Download::Next::Kind::message) {
            next.status = too_large();
        }
        answer(next.message, next.status);
    }

private:
    static grpc::Status too_large() {
        return status_of(LimitError("message_bytes", max_message_bytes,
                                    "the result is too large for one message; ask for it in a stream"));
    }

    /// Finishes the call. Has no effect after the first time.
    void answer(const grpc::ByteBuffer& message, const grpc::Status& status) {
        {
            const std::lock_guard lock(mutex_);
            if (std::exchange(answered_, true)) return;
        }
        response_ = message;
        server_.server_log.sent(response_.Length());
        Finish(status);
    }

    ServerContext& server_;
    grpc::CallbackServerContext& context_;
    grpc::ByteBuffer& response_;
    std::shared_ptr<SmallCall> self_;  // keeps the object alive until OnDone
    Admission admission_;
    std::shared_ptr<ServerJob> job_;
    Budget::Reservation attached_;
    std::mutex mutex_;
    bool answered_ = false;
};

}  // namespace

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_detect(ServerContext& server,
                                                                          grpc::CallbackServerContext& context) {
    const auto call = std::make_shared<DetectCall>(server, context);
    call->start();
    return call.get();
}

grpc::ServerUnaryReactor* start_detect_small(ServerContext& server, grpc::CallbackServerContext& context,
                                             const grpc::ByteBuffer& request, grpc::ByteBuffer& response) {
    const auto call = std::make_shared<SmallCall>(server, context, response);
    call->start(request);
    return call.get();
}

}  // namespace octopair::service
