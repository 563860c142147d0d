#include "service/server/calls/upload.hpp"

#include <grpcpp/support/byte_buffer.h>

#include <string>
#include <vector>

#include "octopair/error.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

void Upload::take(grpc::ByteBuffer& message) {
    came_ += message.Length();
    v1::Upload small;
    // The first message may have data, which come behind what says how much they are.
    std::vector<std::byte> held;
    const auto hold = [&](std::span<const std::byte> data) { held.insert(held.end(), data.begin(), data.end()); };
    const auto append = [&](std::span<const std::byte> data) { this->append(data); };
    const bool first = target_ == nullptr;
    if (!unpack(message, small, first ? TakeBytes(hold) : TakeBytes(append))) {
        throw Error(ErrorCode::bad_input, "a message that is none");
    }
    if (small.has_spec() != first) {
        throw Error(ErrorCode::bad_input, first ? "the first message says no job" : "a second job in one call");
    }
    if (first) {
        small.mutable_spec()->DiscardUnknownFields();  // the job is kept as long as its result, and on disk
        target_ = &begin_(std::move(*small.mutable_spec()));
        missing_ = target_->missing();
        append(held);
    }
}

/// A job whose input is complete may run, or have ended: then the input is not ours any more.
void Upload::append(std::span<const std::byte> data) {
    if (data.empty()) return;
    check_fits(data, missing_);
    target_->append(data);
    missing_ -= data.size();
}

bool Upload::moves() {
    constexpr std::size_t least = std::size_t(64) << 10;
    if (came_ < least) return false;
    came_ = 0;
    return true;
}

void Upload::finish() const {
    if (complete()) return;
    throw Error(ErrorCode::bad_input, target_ == nullptr ? std::string("a call without a job")
                                                         : "the upload ended " + std::to_string(missing_) +
                                                               " bytes before the job's objects were complete");
}

}  // namespace octopair::service
