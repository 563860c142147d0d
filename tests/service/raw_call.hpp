// Calls message by message, as a client makes them that is not ours: any bytes, in any order.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "octopair/objects.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::test {

/// A connection of its own.
std::shared_ptr<grpc::Channel> open_channel(const std::string& address);

/// A stream. Every step waits for its end, a minute at most.
class RawCall {
public:
    explicit RawCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method = "Detect");
    RawCall(const RawCall&) = delete;
    RawCall& operator=(const RawCall&) = delete;
    /// Cancels what is not over.
    ~RawCall();

    bool write(const grpc::ByteBuffer& message);
    bool writes_done();
    std::optional<grpc::ByteBuffer> read();
    /// Reads what is left, and says how the call ended.
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

/// One message each way.
grpc::Status call_small(const std::shared_ptr<grpc::Channel>& channel, const grpc::ByteBuffer& question,
                        grpc::ByteBuffer* answer = nullptr);

/// With a new id.
v1::JobSpec spec_of(std::uint64_t objects);
/// A message with the spec, if there is one, and data.
grpc::ByteBuffer upload_of(const v1::JobSpec* spec, const std::string& data);
/// So many boxes apart from each other.
std::string bytes_of_boxes(std::uint64_t objects);
grpc::ByteBuffer buffer_of(const std::string& bytes);

/// The failure that a status carries; its message is empty if it carries none.
v1::Failure failure_in(const grpc::Status& status);

}  // namespace octopair::test
