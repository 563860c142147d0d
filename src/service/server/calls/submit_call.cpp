#include "service/server/calls/submit_call.hpp"

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/calls/upload.hpp"
#include "service/server/server_context.hpp"
#include "service/server/store/detached_jobs.hpp"
#include "service/server/store/state_folder.hpp"

namespace octopair::service {

namespace {

using Clock = std::chrono::steady_clock;

/// Reads the upload, then has it committed by an errand, which answers. Whatever ends the call first, ends it alone.
class SubmitCall final : public grpc::ServerReadReactor<grpc::ByteBuffer>,
                         public Watched,
                         public std::enable_shared_from_this<SubmitCall> {
public:
    SubmitCall(ServerContext& server, grpc::ByteBuffer& response)
        : server_(server), response_(response), upload_([this](v1::JobSpec spec) -> InputTarget& {
              submission_ = server_.detached->begin(owner_, std::move(spec));
              return *submission_.upload;
          }) {}

    void start(const grpc::CallbackServerContext& context) {
        self_ = shared_from_this();
        const grpc::Status status = server_.let_in(context, owner_);
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
        if (upload_.moves()) {
            const std::lock_guard lock(mutex_);
            moved_ = Clock::now();
        }
        StartRead(&in_);
    }

    void OnCancel() override { end_unless_committing({grpc::StatusCode::CANCELLED, "cancelled"}); }
    void OnDone() override { self_.reset(); }

    void look(Clock::time_point now) override {
        {
            const std::lock_guard lock(mutex_);
            if (ended_ || committing_ || now - moved_ < server_.options.stall) return;
        }
        end_unless_committing(server_.refuse_stalled(owner_));
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
            // It was released while it was submitted again: the client does so once more.
            if (!job) return end({grpc::StatusCode::UNAVAILABLE, "the job was released meanwhile"});
            response_ = pack(server_.report(*job));
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
        Finish(status);
    }

    ServerContext& server_;
    grpc::ByteBuffer& response_;
    std::shared_ptr<SubmitCall> self_;  // until the call is done
    std::string owner_;
    // The reading side's, then the errand's.
    grpc::ByteBuffer in_;
    Submission submission_;
    Upload upload_;

    std::mutex mutex_;
    Clock::time_point moved_ = Clock::now();  // when enough was last read
    bool committing_ = false;
    bool ended_ = false;
};

}  // namespace

grpc::ServerReadReactor<grpc::ByteBuffer>* start_submit(ServerContext& server, grpc::CallbackServerContext& context,
                                                        grpc::ByteBuffer& response) {
    const auto call = std::make_shared<SubmitCall>(server, response);
    call->start(context);
    return call.get();
}

}  // namespace octopair::service
