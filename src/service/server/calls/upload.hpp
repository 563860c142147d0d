// Upload: the messages of a client that make a job: what it asks, then its data.
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
    /// Makes the job, and says where its input goes; that must live until it is complete.
    using Begin = std::function<InputTarget&(v1::JobSpec)>;

    explicit Upload(Begin begin) : begin_(std::move(begin)) {}

    /// Throws Error: what `begin` throws, and Error{bad_input} for a message that has no place here.
    void take(grpc::ByteBuffer& message);
    bool complete() const { return target_ != nullptr && missing_ == 0; }
    /// Whether enough came since this was last true: messages with next to nothing do not keep an upload alive.
    bool moves();
    /// No more messages will come. Throws Error{bad_input} if some are missing.
    void finish() const;

private:
    void append(std::span<const std::byte> data);

    Begin begin_;
    InputTarget* target_ = nullptr;  // none before the first message
    std::uint64_t missing_ = 0;      // bytes of the input
    std::size_t came_ = 0;           // bytes since it moved
};

}  // namespace octopair::service
