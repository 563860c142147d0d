#include "service/client/received.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/pair_list.hpp"
#include "octopair/error.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/messages.hpp"

namespace octopair::service {

void Received::take(grpc::ByteBuffer& message) {
    v1::Download small;
    const std::size_t pairs = unpack_pairs(message, small);
    const bool begins = small.has_head() || headed_;
    if (!begins || !(small.progress() >= 0 && small.progress() <= 1)) refuse_message();
    if (small.has_head()) check_head(small.head());
    headed_ = true;
    if (output_.list != nullptr) {
        detail::storage_of(*output_.list).append(room_.first(pairs));
        room_ = room_.subspan(pairs);
    } else if (output_.sink != nullptr && pairs > 0) {
        (*output_.sink)(std::span(held_).first(pairs));
    }
    pairs_ += pairs;
    if (small.has_progress() && small.progress() > progress_) {
        progress_ = small.progress();
        if (control_.progress) control_.progress(progress_);
    }
    if (small.has_summary()) summary_ = std::move(*small.mutable_summary());
}

/// Unpacks a message. Writes its pairs to the front of `room_` (with a list) or `held_` (without). Returns the number of pairs.
std::size_t Received::unpack_pairs(grpc::ByteBuffer& message, v1::Download& small) {
    const std::size_t most = message.Length() / sizeof(Pair) + 1;
    std::size_t bytes = 0;
    // A pair may be split between two pieces of the message, so pieces are joined first.
    if (output_.list != nullptr && room_.size() < most) {
        room_ =
            detail::storage_of(*output_.list).take_block(std::clamp<std::size_t>(pairs_, most, std::size_t(1) << 20));
    } else if (output_.list == nullptr) {
        held_.resize(most);
    }
    auto* const place = reinterpret_cast<std::byte*>(output_.list != nullptr ? room_.data() : held_.data());
    const bool right = unpack(message, small, [&](std::span<const std::byte> piece) {
        std::memcpy(place + bytes, piece.data(), piece.size());
        bytes += piece.size();
    });
    if (!right || bytes % sizeof(Pair) != 0) refuse_message();
    return bytes / sizeof(Pair);
}

void Received::refuse_message() const {
    throw Error(ErrorCode::engine_failed, server_ + ": the answer is not a valid message of octopair's protocol");
}

/// Throws if earlier attempts received pairs of a result with another hash.
void Received::check_head(const v1::ResultHead& head) {
    if (pairs_ > 0 && head.hash() != hash_) {
        throw Error(ErrorCode::engine_failed,
                    server_ + ": the server's version changed in the middle of a result; call again");
    }
    hash_ = head.hash();
}

Summary Received::finish() {
    if (!summary_ || (is_wanted() && summary_->pairs() != pairs_)) {
        throw Error(ErrorCode::engine_failed, server_ + ": the answer is not complete");
    }
    if (control_.progress && progress_ < 1) control_.progress(1);
    return summary_of(*summary_);
}

}  // namespace octopair::service
