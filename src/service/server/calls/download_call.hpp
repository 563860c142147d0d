// DownloadCall: a call that brings a job's pairs to a client: the half of it that writes.
//
// Whatever may be written is written as soon as nothing else is. What gRPC is asked to do may call back on the spot, so it is
// asked with no lock held; `writing_` and `finished_` say whose turn it is.
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
#include "service/server/calls/download.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

/// Reactor: gRPC's, of a call that streams bytes to the client. Owned by a shared pointer, and by itself while it runs.
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
        ok ? pump() : refuse({grpc::StatusCode::CANCELLED, "the client does not read"});
    }

    void OnCancel() final { refuse({grpc::StatusCode::CANCELLED, "cancelled"}); }

    void OnDone() final {
        done();
        self_.reset();
    }
    // NOLINTEND(readability-identifier-naming)

    void job_changed() final { pump(); }

    void look(std::chrono::steady_clock::time_point now) final {
        bool stuck = false, downloading = false;
        {
            const std::lock_guard lock(mutex_);
            if (finished_) return;
            downloading = download_.has_value();
            const bool late = now - moved_ >= server_.options.stall;
            stuck = late && writing_;
            if (!late && !(downloading && server_.draining)) return;
        }
        if (stuck) return context_.TryCancel();
        waits(downloading);
    }

protected:
    /// From here to done() the call holds itself, which is what `self` points to. False: the caller is not let in.
    bool begin(std::shared_ptr<DownloadCall> self) {
        self_ = std::move(self);
        const grpc::Status status = server_.let_in(context_, owner_);
        if (!status.ok()) refuse(status);
        if (status.ok()) server_.watchdog.watch(self_);
        return status.ok();
    }

    const std::string& owner() const { return owner_; }
    ServerContext& server() { return server_; }

    /// The client has sent enough.
    void moved() {
        const std::lock_guard lock(mutex_);
        moved_ = std::chrono::steady_clock::now();
    }

    void send(const std::shared_ptr<ServerJob>& job, std::uint64_t offset) {
        {
            const std::lock_guard lock(mutex_);
            download_.emplace(job, offset);
        }
        job->watch(self_);
        pump();
    }

    /// Ends the call as soon as nothing is being written.
    void refuse(const grpc::Status& status) {
        {
            const std::lock_guard lock(mutex_);
            if (!refusal_) refusal_ = status;
        }
        refused();
        pump();
    }

private:
    /// The call will end without the rest of the pairs.
    virtual void refused() {}
    virtual void done() {}
    /// Nothing was to be written for long; or pairs are, and the server is going down.
    virtual void waits(bool downloading) = 0;

    /// Writes what there is, unless something is being written.
    void pump() {
        Download::Next next;
        {
            const std::lock_guard lock(mutex_);
            if (writing_ || finished_ || (!refusal_ && !download_)) return;
            next = refusal_ ? Download::Next{Download::Next::Kind::last, {}, *refusal_} : download_->next();
            if (next.kind == Download::Next::Kind::wait) return;
            (next.kind == Download::Next::Kind::last ? finished_ : writing_) = true;
            moved_ = std::chrono::steady_clock::now();
            out_ = next.message;
        }
        server_.server_log.sent(out_.Length());
        if (next.kind == Download::Next::Kind::message) return this->StartWrite(&out_);
        if (!next.status.ok()) return this->Finish(next.status);
        this->StartWriteAndFinish(&out_, {}, next.status);
    }

    ServerContext& server_;
    grpc::CallbackServerContext& context_;
    std::shared_ptr<DownloadCall> self_;  // until the call is done
    std::string owner_;

    std::mutex mutex_;
    std::optional<Download> download_;
    std::optional<grpc::Status> refusal_;
    grpc::ByteBuffer out_;
    std::chrono::steady_clock::time_point moved_ = std::chrono::steady_clock::now();  // enough read, or begun to write
    bool writing_ = false;
    bool finished_ = false;
};

}  // namespace octopair::service
