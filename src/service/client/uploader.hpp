// Uploader: creates the messages that send a job to a server: its spec, then its data.
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
    /// Borrows the arrays.
    Uploader(v1::JobSpec spec, const InputArrays& arrays) : spec_(std::move(spec)), arrays_(arrays) {}

    const v1::JobSpec& spec() const { return spec_; }
    std::uint64_t bytes() const { return input_bytes(spec_); }

    /// Sets the id of the job. Requires: called before the first message.
    void set_id(const std::string& id) { spec_.set_id(id); }

    /// Starts again with the first message. The server then omits the first `offset` pairs.
    void restart(std::uint64_t offset);
    /// Returns whether next() has returned the last message.
    bool done() const { return begun_ && sent_ == bytes(); }
    /// Returns the fraction of the data that has been sent, from 0 to 1.
    double progress() const { return bytes() == 0 ? 1 : double(sent_) / double(bytes()); }
    /// Returns the next message. Requires: !done().
    grpc::ByteBuffer next();

private:
    std::size_t fill(std::span<std::byte> piece);

    v1::JobSpec spec_;
    const InputArrays arrays_;
    std::size_t array_ = 0;
    std::uint64_t at_ = 0;    // bytes sent of the current array
    std::uint64_t sent_ = 0;  // bytes sent of all arrays
    bool begun_ = false;
};

}  // namespace octopair::service
