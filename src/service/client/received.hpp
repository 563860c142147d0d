// Received: the result of a job, as its messages come; over all attempts to get it.
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/request.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

class Received {
public:
    /// All are borrowed. `server` is its name in messages.
    Received(const std::string& server, const detail::Output& output, const detail::Control& control)
        : server_(server), output_(output), control_(control) {}

    /// What comes from here on is another answer, which has a head of its own.
    void begin_attempt() { headed_ = false; }
    /// What the server sent: pairs, how far it is, or the end. Throws Error, and what a sink or a progress throws.
    void take(grpc::ByteBuffer& message);

    /// So many are here.
    std::uint64_t pairs() const { return pairs_; }
    /// Of the result; empty before the first message.
    const std::string& hash() const { return hash_; }
    /// When nothing more will come. Throws Error{engine_failed} if that is not all of the result, and what a progress throws.
    Summary finish();

private:
    bool is_wanted() const { return output_.list != nullptr || output_.sink != nullptr; }
    std::size_t unpack_pairs(grpc::ByteBuffer& message, v1::Download& small);
    [[noreturn]] void refuse_message() const;
    void check_head(const v1::ResultHead& head);

    const std::string& server_;
    const detail::Output& output_;
    const detail::Control& control_;
    std::string hash_;
    std::uint64_t pairs_ = 0;
    bool headed_ = false;  // this answer has begun
    double progress_ = 0;
    std::optional<v1::Summary> summary_;
    std::span<Pair> room_;  // of the list
    std::vector<Pair> held_;
};

}  // namespace octopair::service
