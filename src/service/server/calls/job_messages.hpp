// Upload and Download: the messages of a job in both directions.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/status.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "service/server/jobs/server_job.hpp"
#include "service/server/jobs/uploaded_input.hpp"

namespace grpc {
class ByteBuffer;
}  // namespace grpc

namespace octopair::v1 {
class JobSpec;
}  // namespace octopair::v1

namespace octopair::service {

/// Reads the messages with which a client submits a job: first the job spec, then the input of the job.
class Upload {
public:
    /// Creates the job and returns the target of its input. Requires: the target lives until the input is complete.
    using Begin = std::function<InputTarget&(v1::JobSpec)>;

    explicit Upload(Begin begin) : begin_(std::move(begin)) {}

    /// Reads the next message. Throws: what `begin` throws; Error{bad_input} for a message that is invalid or unexpected.
    void take(grpc::ByteBuffer& message);
    bool complete() const { return target_ != nullptr && missing_ == 0; }
    /// Returns whether at least 64 KiB were received since the call that last returned true. A client that sends tiny messages
    /// therefore still runs into the stall timeout.
    bool take_progress();
    /// Ends the upload. Throws: Error{bad_input} if a part of the job is missing.
    void finish() const;

private:
    void append(std::span<const std::byte> data);

    Begin begin_;
    InputTarget* target_ = nullptr;  // null before the first message
    std::uint64_t missing_ = 0;      // bytes of the input that were not received yet
    std::size_t new_bytes_ = 0;      // bytes received since take_progress() returned true
};

/// Makes the messages that send the pairs of a job to a client, starting at a given pair.
class Download {
public:
    explicit Download(std::shared_ptr<ServerJob> job, std::uint64_t offset = 0)
        : job_(std::move(job)), offset_(offset) {}

    struct Next {
        enum class Kind : std::uint8_t { wait, message, last } kind = Kind::wait;
        grpc::ByteBuffer message;  ///< set for `message`, and for `last` if `status` is OK
        grpc::Status status;       ///< status of the call; set for `last`
    };
    /// Returns what to send next: nothing yet, a message, or the last message and the status that ends the call.
    Next next();

private:
    Next make_next();

    std::shared_ptr<ServerJob> job_;
    std::uint64_t offset_;
    bool head_sent_ = false;
    double progress_sent_ = 0;
};

}  // namespace octopair::service
