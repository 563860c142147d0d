#include "base/checksum.hpp"

#include <bit>
#include <cstring>

namespace octopair {

static_assert(std::endian::native == std::endian::little, "the bytes of a number are processed as they lie in memory");

void Checksum::add(std::span<const std::byte> bytes) {
    constexpr std::size_t word = sizeof(std::uint64_t);
    std::size_t at = 0;
    const auto add_byte = [&] {
        part_ |= std::to_integer<std::uint64_t>(bytes[at++]) << 8 * (length_ % word);
        if (++length_ % word != 0) return;
        state_ = mixed(state_, part_);
        part_ = 0;
    };
    while (at < bytes.size() && length_ % word != 0) add_byte();
    for (; at + word <= bytes.size(); at += word, length_ += word) {
        std::uint64_t number = 0;
        std::memcpy(&number, bytes.data() + at, word);
        state_ = mixed(state_, number);
    }
    while (at < bytes.size()) add_byte();
}

std::uint64_t Checksum::value() const {
    const bool part = length_ % sizeof(std::uint64_t) != 0;
    return mixed(part ? mixed(state_, part_) : state_, length_);
}

}  // namespace octopair
