#include "service/client/uploader.hpp"

#include <algorithm>
#include <cstring>

#include "service/protocol/messages.hpp"

namespace octopair::service {

void Uploader::restart(std::uint64_t offset) {
    spec_.set_offset(offset);
    sent_ = array_ = at_ = 0;
    begun_ = false;
}

grpc::ByteBuffer Uploader::next() {
    v1::Upload small;
    if (!std::exchange(begun_, true)) *small.mutable_spec() = spec_;
    const grpc::Slice piece = make_slice(std::size_t(std::min<std::uint64_t>(bytes() - sent_, piece_bytes)));
    sent_ += fill(room_in(piece));
    return pack(small, piece);
}

std::size_t Uploader::fill(std::span<std::byte> piece) {
    std::size_t filled = 0;
    while (filled < piece.size()) {
        const auto rest = arrays_[array_].subspan(std::size_t(at_));
        const std::size_t count = std::min(rest.size(), piece.size() - filled);
        if (count > 0) std::memcpy(piece.data() + filled, rest.data(), count);
        filled += count;
        at_ += count;
        if (count == rest.size()) {
            ++array_;
            at_ = 0;
        }
    }
    return filled;
}

}  // namespace octopair::service
