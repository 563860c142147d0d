// Received: collects the result of a job from the server's messages, over all attempts to receive it.
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
    /// Borrows all arguments. `server` names the server in error messages.
    Received(const std::string& server, const detail::Output& output, const detail::Control& control)
        : server_(server), output_(output), control_(control) {}

    /// Starts a new attempt. Its first message has a head again.
    void begin_attempt() { headed_ = false; }
    /// Processes a message of the server: pairs, progress or summary.
    /// Throws: Error{engine_failed} if the message is invalid; what the sinks for pairs and progress throw.
    void take(grpc::ByteBuffer& message);

    /// Returns the number of pairs received so far, in all attempts.
    std::uint64_t pairs() const { return pairs_; }
    /// Returns the hash of the result; empty before the first message.
    const std::string& hash() const { return hash_; }
    /// Returns the summary after the last message.
    /// Throws: Error{engine_failed} if the result is incomplete; what the progress sink throws.
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
    bool headed_ = false;  // the head of this attempt has been received
    double progress_ = 0;
    std::optional<v1::Summary> summary_;
    std::span<Pair> room_;    // unused part of the list's current block
    std::vector<Pair> held_;  // pairs of the current message, if there is no list
};

}  // namespace octopair::service
