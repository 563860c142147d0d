// Uploader: the messages that bring a job to a server: what it asks, then its data.
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "service/protocol/job_spec.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

class Uploader {
public:
    /// The arrays are borrowed.
    Uploader(v1::JobSpec spec, const InputArrays& arrays) : spec_(std::move(spec)), arrays_(arrays) {}

    const v1::JobSpec& spec() const { return spec_; }
    std::uint64_t bytes() const { return input_bytes(spec_); }

    /// Before the first message.
    void set_id(const std::string& id) { spec_.set_id(id); }

    /// From the beginning; the pairs before `offset` are not wanted.
    void restart(std::uint64_t offset);
    /// The last message was taken.
    bool done() const { return begun_ && sent_ == bytes(); }
    /// 0 to 1.
    double progress() const { return bytes() == 0 ? 1 : double(sent_) / double(bytes()); }
    /// The next message.
    grpc::ByteBuffer next();

private:
    std::size_t fill(std::span<std::byte> piece);

    v1::JobSpec spec_;
    const InputArrays arrays_;
    std::size_t array_ = 0;
    std::uint64_t at_ = 0;    // bytes of the array
    std::uint64_t sent_ = 0;  // bytes in all
    bool begun_ = false;
};

}  // namespace octopair::service
