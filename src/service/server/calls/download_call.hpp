// DownloadCall: base class of calls that send a job's pairs to a client. It implements the writing half of the call.
//
// Invariants:
//  - At most one write is in progress: `writing_` is true from StartWrite until OnWriteDone.
//  - Nothing is written after `finished_` is true.
//  - No lock is held while gRPC is called, because gRPC may call back before it returns.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "service/protocol/status.hpp"
#include "service/server/calls/job_messages.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

/// `Reactor`: gRPC's reactor of a call that streams bytes to the client. A shared pointer owns the object. While the call runs,
/// the object also owns itself (`self_`).
template <typename Reactor>
class DownloadCall : public Reactor, public JobWatcher, public Watched {
public:
    DownloadCall(ServerContext& server, grpc::CallbackServerContext& context) : server_(server), context_(context) {}

    // NOLINTBEGIN(readability-identifier-naming): gRPC's names.
    void OnWriteDone(bool ok) final {
        {
            const std::lock_guard lock(mutex_);
            writing_ = false;
        }
        ok ? pump_soon() : refuse({grpc::StatusCode::CANCELLED, "the client does not read"});
    }

    void OnCancel() final { refuse({grpc::StatusCode::CANCELLED, "cancelled"}); }

    void OnDone() final {
        done();
        self_.reset();
    }
    // NOLINTEND(readability-identifier-naming)

    void job_changed() final { pump_soon(); }

    void check_deadline(std::chrono::steady_clock::time_point now) final {
        bool stuck = false, downloading = false;
        {
            const std::lock_guard lock(mutex_);
            if (finished_) return;
            downloading = download_.has_value();
            const bool late = now - last_progress_ >= server_.options.stall;
            stuck = late && writing_;
            if (!late && !(downloading && server_.draining)) return;
        }
        if (stuck) return context_.TryCancel();
        handle_stall(downloading);
    }

protected:
    /// Starts the call and admits the caller. Returns false if the caller is refused. The call keeps `self` until done().
    /// Requires: `self` points to this object.
    bool begin(std::shared_ptr<DownloadCall> self, Right right) {
        self_ = std::move(self);
        const grpc::Status status = server_.admit(context_, right, admission_);
        if (!status.ok()) refuse(status);
        if (status.ok()) server_.watchdog.watch(self_);
        return status.ok();
    }

    const Caller& caller() const { return admission_.caller; }
    const grpc::ServerContextBase& context() const { return context_; }
    ServerContext& server() { return server_; }

    /// Returns what was sent until the call ended. Requires: called in done().
    Sent sent() const { return {download_ ? first_pair_ : 0, sent_bytes_, outcome_}; }

    /// Restarts the stall timeout: the client has sent enough data.
    void note_progress() {
        const std::lock_guard lock(mutex_);
        last_progress_ = std::chrono::steady_clock::now();
    }

    /// Sends the pairs of `job`, starting at pair `offset`, as they are found.
    void send(const std::shared_ptr<ServerJob>& job, std::uint64_t offset) {
        {
            const std::lock_guard lock(mutex_);
            download_.emplace(job, offset);
            first_pair_ = offset;
        }
        job->watch(self_);
        pump_soon();
    }

    /// Ends the call with `status`, after the write in progress.
    void refuse(const grpc::Status& status) {
        {
            const std::lock_guard lock(mutex_);
            if (!refusal_) refusal_ = status;
        }
        refused();
        pump_soon();
    }

    /// Writes the next message if one is ready and no write is in progress.
    void pump() {
        Download::Next next;
        {
            const std::lock_guard lock(mutex_);
            if (writing_ || finished_ || (!refusal_ && !download_)) return;
            next = refusal_ ? Download::Next{Download::Next::Kind::last, {}, *refusal_} : download_->next();
            if (next.kind == Download::Next::Kind::wait) return;
            (next.kind == Download::Next::Kind::last ? finished_ : writing_) = true;
            last_progress_ = std::chrono::steady_clock::now();
            out_ = next.message;
            sent_bytes_ += out_.Length();
            if (finished_) outcome_ = next.status.ok() ? "complete" : next.status.error_message();
        }
        server_.server_log.sent(out_.Length());
        if (next.kind == Download::Next::Kind::message) return this->StartWrite(&out_);
        if (!next.status.ok()) return this->Finish(next.status);
        this->StartWriteAndFinish(&out_, {}, next.status);
    }

private:
    /// Calls pump() now or soon, on any thread.
    virtual void pump_soon() { pump(); }
    /// Called when the call is going to end before all pairs were sent.
    virtual void refused() {}
    virtual void done() {}
    /// Called when nothing was written for the stall timeout, or when pairs are sent while the server shuts down.
    virtual void handle_stall(bool downloading) = 0;

    ServerContext& server_;
    grpc::CallbackServerContext& context_;
    std::shared_ptr<DownloadCall> self_;  // keeps the object alive until OnDone
    Admission admission_;

    std::mutex mutex_;
    std::optional<Download> download_;
    std::optional<grpc::Status> refusal_;
    grpc::ByteBuffer out_;
    /// Time of the last progress of the upload, or of the start of a write.
    std::chrono::steady_clock::time_point last_progress_ = std::chrono::steady_clock::now();
    std::uint64_t first_pair_ = 0, sent_bytes_ = 0;
    std::string outcome_;
    bool writing_ = false;
    bool finished_ = false;
};

}  // namespace octopair::service
