#include "service/client/raw_stream.hpp"

#include <grpcpp/channel.h>

#include <utility>

#include "service/client/connection.hpp"

namespace octopair::service {

RawStream::RawStream(Connection& connection, Terms terms) : connection_(connection), terms_(std::move(terms)) {
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
    call_ = grpc::GenericStub(connection_.channel()).PrepareCall(&context_, terms_.method, &queue_);
    call_->StartCall(tag(Event::started));
    pending_ = 1;
    while (pending_ > 0) {
        void* event = nullptr;
        bool ok = false;
        if (!queue_.Next(&event, &ok)) break;
        --pending_;
        handle(Event(reinterpret_cast<std::uintptr_t>(event)), ok);
    }
    if (failure_) std::rethrow_exception(failure_);
    return status_;
}

void RawStream::handle(Event event, bool ok) {
    // Other events show only that gRPC took something: it does so also for a server that ends each call.
    if (ok && event == Event::read) connection_.heard();
    switch (event) {
        case Event::started:
            ok ? read() : finish();
            if (ok) write();
            break;
        case Event::read:
            ok&& guarded([&] { terms_.take(in_); }) ? read() : finish();
            break;
        case Event::written:
            if (ok) write();  // after a failed write, the read fails as well and finish() gets the status
            break;
        case Event::writes_done:
        case Event::finished:
            break;
    }
}

void RawStream::read() {
    ++pending_;
    call_->Read(&in_, tag(Event::read));
}

void RawStream::write() {
    std::optional<grpc::ByteBuffer> message;
    if (!guarded([&] { message = terms_.next(); })) return;
    ++pending_;
    message ? call_->Write(*message, tag(Event::written)) : call_->WritesDone(tag(Event::writes_done));
}

void RawStream::finish() {
    if (std::exchange(finishing_, true)) return;
    ++pending_;
    call_->Finish(&status_, tag(Event::finished));
}

}  // namespace octopair::service
