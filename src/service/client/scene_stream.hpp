// SceneStream: one call Scene to a server, in the caller's thread.
#pragma once

#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/support/async_stream.h>
#include <grpcpp/support/byte_buffer.h>

#include <array>
#include <cstdint>
#include <memory>
#include <stop_token>

#include "scene/recording/recording.hpp"

namespace octopair::service {

class Connection;

class SceneStream {
public:
    /// Thrown when the server has ended the call, or cannot be reached: status() says why.
    struct Ended {};

    /// Begins the call; whether there is a server turns out later.
    explicit SceneStream(Connection& connection);
    SceneStream(const SceneStream&) = delete;
    SceneStream& operator=(const SceneStream&) = delete;
    /// Cancels what is under way.
    ~SceneStream();

    /// Ends the call from any thread: what waits throws Ended.
    void cancel() { context_.TryCancel(); }
    /// Sends a piece of calls; returns before all of it is on its way. Throws Ended.
    void send(Bytes calls);
    /// The next message. Throws Ended.
    grpc::ByteBuffer receive();
    /// Once Ended was thrown.
    const grpc::Status& status() const { return status_; }

private:
    enum class Event : std::uint8_t { started, read, written, finished };

    void* tag(Event event) { return &events_[std::size_t(event)]; }
    void read();
    void wait();
    void handle(Event event, bool ok);

    std::array<Event, 4> events_ = {Event::started, Event::read, Event::written, Event::finished};
    grpc::ClientContext context_;
    grpc::CompletionQueue queue_;
    std::unique_ptr<grpc::ClientAsyncReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> call_;
    grpc::ByteBuffer in_;
    grpc::Status status_;
    bool started_ = false, writing_ = false, received_ = false, finished_ = false;
};

}  // namespace octopair::service
