// Recordings: the calls of a scene in a file (docs/formats.md). What the recorder and the reader share.
//
//   file     magic (8 bytes), version (u32), precision (u32: 32 or 64), margin (f64), checksum of all these (u64), records
//   record   kind (u32), check (u32), length (u64), payload (length bytes), checksum of all these (u64)
//   check    the low half of the checksum of the record's first 16 bytes with 0 in its own place: so a length that was
//            damaged is known as such, and not taken for that of a record which was cut
//
// Everything is little endian. A record is of one call that was found valid; a step's is written before it is taken, and a
// record of its result follows when it succeeded.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "octopair/scene.hpp"

namespace octopair {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

using Bytes = std::span<const std::byte>;

template <typename T>
Bytes bytes_of(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}

/// 64 bits over bytes: their length and order count. The bytes are taken as numbers of 64 bits, the last one filled up
/// with zeros, and how many bytes there were as one number more. Any change within one number changes the checksum.
class Checksum {
public:
    void add(Bytes bytes);
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
    std::uint64_t part_ = 0;  // the bytes that do not fill a number yet
};

/// What can be in a record. Numbers are never given anew: what needs another meaning gets another number.
enum class RecordKind : std::uint32_t { add = 1, move, sweep, remove, set_traits, step, result };

struct RecordingHead {
    static constexpr std::array<char, 8> right_magic = {'\x93', 'O', 'C', 'T', 'O', 'R', 'E', 'C'};
    static constexpr std::uint32_t newest_version = 1;

    std::array<char, 8> magic = right_magic;
    std::uint32_t version = newest_version;
    std::uint32_t precision = 32;
    double margin = 0;
    std::uint64_t checksum = 0;

    std::uint64_t right_checksum() const;
};
static_assert(sizeof(RecordingHead) == 32);

/// With its checksum.
RecordingHead recording_head(const SceneOptions& options);

struct RecordHead {
    RecordKind kind;
    std::uint32_t check;
    std::uint64_t length;

    std::uint32_t right_check() const;
};
static_assert(sizeof(RecordHead) == 16);

/// Beside its payload.
inline constexpr std::uint64_t record_overhead = sizeof(RecordHead) + sizeof(std::uint64_t);

struct RecordedTraits {
    std::uint32_t groups, mask, fixed;
};
static_assert(sizeof(RecordedTraits) == 12 && sizeof(ObjectId) == 8 && sizeof(Pair) == 8);
static_assert(sizeof(Box3f) == 24 && sizeof(Box3d) == 48);

/// Of a step.
struct RecordedResult {
    std::uint64_t hash = 0;  ///< of all that it found
    std::uint64_t began = 0, ended = 0, persisting = 0;

    bool operator==(const RecordedResult&) const = default;
};
static_assert(sizeof(RecordedResult) == 32);

/// The hash is the checksum of: the number of pairs that began, these, the number of those that ended, these, and the
/// number of those that persist; numbers as u64, pairs as two u32.
RecordedResult recorded_result(const StepResult& result);

}  // namespace octopair
