// Checksum: 64 bits that show whether two sequences of bytes are equal. Not for security: it is easy to make sequences with equal
// checksums.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/private_export.hpp"

namespace octopair {

/// Processes the bytes as 64-bit numbers (the last one padded with zeros), then the number of bytes. Depends on length and order; any
/// change within one 64-bit number changes the checksum. Recordings contain it (docs/formats.md), so it must not change.
class OCTOPAIR_PRIVATE_EXPORT Checksum {
public:
    void add(std::span<const std::byte> bytes);
    void add(std::uint64_t number) { add(std::as_bytes(std::span(&number, 1))); }
    std::uint64_t value() const;

private:
    static constexpr std::uint64_t factor = 0x9e3779b97f4a7c15;

    static std::uint64_t mixed(std::uint64_t state, std::uint64_t number) {
        state = (state ^ number) * factor;
        return state ^ state >> 32;
    }

    std::uint64_t state_ = factor;
    std::uint64_t length_ = 0;
    std::uint64_t part_ = 0;  // bytes of an incomplete 64-bit number
};

}  // namespace octopair
