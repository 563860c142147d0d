#include "service/client/raw_stream.hpp"

#include <grpcpp/channel.h>

#include <utility>

#include "service/client/connection.hpp"

namespace octopair::service {

RawStream::RawStream(Connection& connection, Callbacks callbacks)
    : connection_(connection), callbacks_(std::move(callbacks)) {
    connection_.prepare(context_);
}

/// Runs `step`. If it throws, keeps the exception, cancels the call and returns false. The call must finish before run()
/// rethrows.
template <typename Step>
bool RawStream::guarded(Step&& step) {
    try {
        step();
        return true;
    } catch (...) {
        if (!failure_) failure_ = std::current_exception();
        context_.TryCancel();
        return false;
    }
}

grpc::Status RawStream::run(const std::stop_token& stop) {
    const std::stop_callback cancel(stop, [&] { context_.TryCancel(); });
    call_ = grpc::GenericStub(connection_.channel()).PrepareCall(&context_, callbacks_.method, &queue_);
    call_->StartCall(tag(Completion::started));
    pending_ = 1;
    while (pending_ > 0) {
        void* completion = nullptr;
        bool ok = false;
        if (!queue_.Next(&completion, &ok)) break;
        --pending_;
        handle(Completion(reinterpret_cast<std::uintptr_t>(completion)), ok);
    }
    if (failure_) std::rethrow_exception(failure_);
    return status_;
}

void RawStream::handle(Completion completion, bool ok) {
    // Only a finished read proves that the server answers. gRPC also completes starts and writes of calls that the server ends at once.
    if (ok && completion == Completion::read) connection_.heard();
    switch (completion) {
        case Completion::started:
            ok ? read() : finish();
            if (ok) write();
            break;
        case Completion::read:
            ok&& guarded([&] { callbacks_.take(in_); }) ? read() : finish();
            break;
        case Completion::written:
            if (ok) write();  // after a failed write, the read fails as well and finish() gets the status
            break;
        case Completion::writes_done:
        case Completion::finished:
            break;
    }
}

void RawStream::read() {
    ++pending_;
    call_->Read(&in_, tag(Completion::read));
}

void RawStream::write() {
    std::optional<grpc::ByteBuffer> message;
    if (!guarded([&] { message = callbacks_.next(); })) return;
    ++pending_;
    message ? call_->Write(*message, tag(Completion::written)) : call_->WritesDone(tag(Completion::writes_done));
}

void RawStream::finish() {
    if (std::exchange(finishing_, true)) return;
    ++pending_;
    call_->Finish(&status_, tag(Completion::finished));
}

}  // namespace octopair::service
