// RawStream: one bidirectional streaming call. Reads and writes overlap; callbacks run in the thread that calls run().
#pragma once

#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

namespace octopair::service {

class Connection;

class RawStream {
public:
    /// The method to call, and the functions that the stream calls.
    struct Callbacks {
        const char* method = nullptr;  ///< "/PACKAGE.SERVICE/METHOD"
        /// Returns the next message to the server, or nothing after the last message. An exception cancels the call.
        std::function<std::optional<grpc::ByteBuffer>()> next;
        /// Receives a message from the server. An exception cancels the call.
        std::function<void(grpc::ByteBuffer&)> take;
    };

    RawStream(Connection& connection, Callbacks callbacks);
    RawStream(const RawStream&) = delete;
    RawStream& operator=(const RawStream&) = delete;

    /// Runs the call, and returns its status. Requires: called once. Throws: what the callbacks throw.
    grpc::Status run(const std::stop_token& stop);

private:
    enum class Completion : std::uintptr_t { started = 1, read, written, writes_done, finished };

    // NOLINTNEXTLINE(performance-no-int-to-ptr): gRPC's tags are pointers; these are numbers and never dereferenced.
    static void* tag(Completion completion) { return reinterpret_cast<void*>(std::uintptr_t(completion)); }
    void handle(Completion completion, bool ok);
    void read();
    void write();
    template <typename Step>
    bool guarded(Step&& step);
    void finish();

    Connection& connection_;
    Callbacks callbacks_;
    grpc::ClientContext context_;
    grpc::CompletionQueue queue_;
    std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
    grpc::ByteBuffer in_;
    grpc::Status status_;
    std::exception_ptr failure_;
    int pending_ = 0;
    bool finishing_ = false;
};

}  // namespace octopair::service
