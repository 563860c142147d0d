// Calls that send any bytes in any order, message by message, without octopair's client.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>

#include <memory>
#include <optional>
#include <string>

#include "octopair/objects.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::test {

/// Opens a separate connection.
std::shared_ptr<grpc::Channel> open_channel(const std::string& address);

/// A streaming call. Every step waits for its completion. Throws: std::runtime_error if a step takes over a minute.
class RawCall {
public:
    explicit RawCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method = "Detect");
    RawCall(const RawCall&) = delete;
    RawCall& operator=(const RawCall&) = delete;
    /// Cancels the call if it has not ended.
    ~RawCall();

    bool write(const grpc::ByteBuffer& message);
    bool writes_done();
    std::optional<grpc::ByteBuffer> read();
    /// Reads the remaining messages, and returns the status of the call.
    grpc::Status finish();
    void cancel() { context_.TryCancel(); }

private:
    bool step();

    grpc::ClientContext context_;
    grpc::CompletionQueue queue_;
    grpc::GenericStub stub_;
    std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
    bool over_ = false;
};

/// Makes a call with one message in each direction.
grpc::Status call_small(const std::shared_ptr<grpc::Channel>& channel, const grpc::ByteBuffer& question,
                        grpc::ByteBuffer* answer = nullptr);

/// Makes a spec with a new id.
v1::JobSpec spec_of(std::uint64_t objects);
/// Makes a message with data, and with the spec if `spec` is not null.
grpc::ByteBuffer upload_of(const v1::JobSpec* spec, const std::string& data);
/// Returns the bytes of `objects` boxes that do not touch.
std::string bytes_of_boxes(std::uint64_t objects);
grpc::ByteBuffer buffer_of(const std::string& bytes);

/// Returns the failure in a status. Its message is empty if the status has no failure.
v1::Failure failure_in(const grpc::Status& status);

}  // namespace octopair::test
