#include "service/server/calls/submit_call.hpp"

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"
#include "service/server/calls/upload.hpp"
#include "service/server/host.hpp"
#include "service/server/store/detached_jobs.hpp"
#include "service/server/store/state_folder.hpp"

namespace octopair::service {

namespace {

using Clock = std::chrono::steady_clock;

/// Reads the upload, then has it committed by an errand, which answers. Whatever ends the call first, ends it alone.
class SubmitCall final : public grpc::ServerReadReactor<grpc::ByteBuffer>,
                         public Overseen,
                         public std::enable_shared_from_this<SubmitCall> {
public:
    SubmitCall(Host& host, grpc::ByteBuffer& response)
        : host_(host), response_(response), upload_([this](v1::JobSpec spec) -> InputTarget& {
              submission_ = host_.detached->begin(owner_, std::move(spec));
              return *submission_.upload;
          }) {}

    void start(const grpc::CallbackServerContext& context) {
        self_ = shared_from_this();
        const grpc::Status status = host_.let_in(context, owner_);
        if (!status.ok()) return end(status);
        if (!host_.detached) {
            return end(status_of(Error(ErrorCode::usage, "the server has no state folder: it takes no detached jobs")));
        }
        host_.overseer.watch(self_);
        StartRead(&in_);
    }

    void OnReadDone(bool ok) override {
        try {
            if (!ok) {
                upload_.finish();
                return commit();
            }
            host_.ledger.received(in_.Length());
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
            if (ended_ || committing_ || now - moved_ < host_.options.stall) return;
        }
        end_unless_committing(host_.refuse_stalled(owner_));
    }

private:
    void commit() {
        {
            const std::lock_guard lock(mutex_);
            if (ended_) return;
            committing_ = true;
        }
        host_.state->errands().add([self = shared_from_this()] { self->commit_now(); });
    }

    void commit_now() {
        try {
            const auto job = host_.detached->commit(submission_);
            // It was released while it was submitted again: the client does so once more.
            if (!job) return end({grpc::StatusCode::UNAVAILABLE, "the job was released meanwhile"});
            response_ = pack(host_.report(*job));
            host_.ledger.sent(response_.Length());
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

    Host& host_;
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

grpc::ServerReadReactor<grpc::ByteBuffer>* start_submit(Host& host, grpc::CallbackServerContext& context,
                                                        grpc::ByteBuffer& response) {
    const auto call = std::make_shared<SubmitCall>(host, response);
    call->start(context);
    return call.get();
}

}  // namespace octopair::service
