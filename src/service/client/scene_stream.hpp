// SceneStream: one streaming call Scene to a server. All work is done in the calling thread.
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
    /// Thrown when the server has ended the call or is unreachable. status() has the reason.
    struct Ended {};

    /// Starts the call. Does not wait for a connection.
    explicit SceneStream(Connection& connection);
    SceneStream(const SceneStream&) = delete;
    SceneStream& operator=(const SceneStream&) = delete;
    /// Cancels the call, and waits for its pending operations.
    ~SceneStream();

    /// Cancels the call. A waiting send() or receive() throws Ended. Thread safety: any thread may call this.
    void cancel() { context_.TryCancel(); }
    /// Sends a piece of the encoded calls. Returns before the write is complete. Throws: Ended.
    void send(Bytes calls);
    /// Waits for the next message, and returns it. Throws: Ended.
    grpc::ByteBuffer receive();
    /// Returns the status of the call. Requires: Ended has been thrown.
    const grpc::Status& status() const { return status_; }

private:
    enum class Completion : std::uint8_t { started, read, written, finished };

    void* tag(Completion completion) { return &completions_[std::size_t(completion)]; }
    void read();
    void wait();
    void handle(Completion completion, bool ok);

    std::array<Completion, 4> completions_ = {Completion::started, Completion::read, Completion::written,
                                              Completion::finished};
    grpc::ClientContext context_;
    grpc::CompletionQueue queue_;
    std::unique_ptr<grpc::ClientAsyncReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> call_;
    grpc::ByteBuffer in_;
    grpc::Status status_;
    bool started_ = false, writing_ = false, received_ = false, finished_ = false;
};

}  // namespace octopair::service
