#include "service/server/calls/upload.hpp"

#include <grpcpp/support/byte_buffer.h>

#include <string>
#include <vector>

#include "octopair/error.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

void Upload::take(grpc::ByteBuffer& message) {
    new_bytes_ += message.Length();
    v1::Upload small;
    // The first message may also carry data. They are held back until the spec, which says how long the input is, was read.
    std::vector<std::byte> held;
    const auto hold = [&](std::span<const std::byte> data) { held.insert(held.end(), data.begin(), data.end()); };
    const auto append = [&](std::span<const std::byte> data) { this->append(data); };
    const bool first = target_ == nullptr;
    if (!unpack(message, small, first ? TakeBytes(hold) : TakeBytes(append))) {
        throw Error(ErrorCode::bad_input, "the message cannot be parsed");
    }
    if (small.has_spec() != first) {
        throw Error(ErrorCode::bad_input,
                    first ? "the first message has no job spec" : "the call has a second job spec");
    }
    if (first) {
        // Unknown fields would take memory and disk space as long as the job exists.
        small.mutable_spec()->DiscardUnknownFields();
        target_ = &begin_(std::move(*small.mutable_spec()));
        missing_ = target_->missing();
        append(held);
    }
}

/// After the last byte the job may run and end, which frees the target. So late data must not reach the target.
void Upload::append(std::span<const std::byte> data) {
    if (data.empty()) return;
    check_fits(data, missing_);
    target_->append(data);
    missing_ -= data.size();
}

bool Upload::take_progress() {
    constexpr std::size_t least = std::size_t(64) << 10;
    if (new_bytes_ < least) return false;
    new_bytes_ = 0;
    return true;
}

void Upload::finish() const {
    if (complete()) return;
    throw Error(ErrorCode::bad_input, target_ == nullptr ? std::string("the call ended before it sent a job spec")
                                                         : "the upload ended " + std::to_string(missing_) +
                                                               " bytes before the job's objects were complete");
}

}  // namespace octopair::service
