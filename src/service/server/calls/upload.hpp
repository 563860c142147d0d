// Upload: reads the messages with which a client submits a job: first the job spec, then the job's input.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "service/server/jobs/input_target.hpp"

namespace grpc {
class ByteBuffer;
}  // namespace grpc

namespace octopair::v1 {
class JobSpec;
}  // namespace octopair::v1

namespace octopair::service {

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

}  // namespace octopair::service
