// Format of recordings: the calls of a scene in a file (docs/formats.md). Shared by the recorder and the reader.
//
//   file     magic (8 bytes), version (u32), precision (u32: 32 or 64), margin (f64), checksum of all these (u64), records
//   record   kind (u32), check (u32), length (u64), payload (length bytes), checksum of all these (u64)
//   check    low 32 bits of the checksum of the record's first 16 bytes, computed with check = 0. It distinguishes a damaged
//            length from the length of a truncated record
//
// All numbers are little endian. A record holds one valid call. The record of a step is written before the step runs; a
// record of its result follows if the step succeeded.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "base/checksum.hpp"
#include "base/private_export.hpp"
#include "octopair/scene.hpp"

namespace octopair {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

using Bytes = std::span<const std::byte>;

template <typename T>
Bytes bytes_of(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}

/// Kind of a record. Numbers are part of the file format and are never reused for another meaning.
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

/// Returns the head of a recording, including its checksum.
OCTOPAIR_PRIVATE_EXPORT RecordingHead recording_head(const SceneOptions& options);

struct RecordHead {
    RecordKind kind;
    std::uint32_t check;
    std::uint64_t length;

    std::uint32_t right_check() const;
};
static_assert(sizeof(RecordHead) == 16);

/// Bytes of a record besides its payload.
inline constexpr std::uint64_t record_overhead = sizeof(RecordHead) + sizeof(std::uint64_t);

struct RecordedTraits {
    std::uint32_t groups, mask, fixed;
};
static_assert(sizeof(RecordedTraits) == 12 && sizeof(ObjectId) == 8 && sizeof(Pair) == 8);
static_assert(sizeof(Box3f) == 24 && sizeof(Box3d) == 48);

/// Result of a step.
struct RecordedResult {
    std::uint64_t hash = 0;  ///< checksum of all that the step found: recorded_result()
    std::uint64_t began = 0, ended = 0, persisting = 0;

    bool operator==(const RecordedResult&) const = default;
};
static_assert(sizeof(RecordedResult) == 32);

/// Returns the record of a result. Its hash is the checksum of: number of pairs that began, these pairs, number of pairs that
/// ended, these pairs, number of pairs that persist. Numbers are u64; a pair is two u32.
RecordedResult recorded_result(const StepResult& result);

/// The parts of a record before and after its payload.
struct RecordEnvelope {
    RecordHead head;
    std::uint64_t checksum;
};

/// Returns the envelope of a record. Its payload is the concatenation of `pieces`.
OCTOPAIR_PRIVATE_EXPORT RecordEnvelope envelope_of(RecordKind kind, std::initializer_list<Bytes> pieces);

/// Encodes the calls of a scene as records. Derived classes store or send the records.
class OCTOPAIR_PRIVATE_EXPORT CallEncoder {
public:
    virtual ~CallEncoder() = default;

    /// All calls throw: Error{resource_limit} for more than 2^32 - 1 objects; everything that append() throws.
    virtual void add(const Objects& objects, std::span<const Traits> traits);
    /// Requires: `kind` is move or sweep.
    virtual void move(RecordKind kind, std::span<const ObjectId> ids, const Boxes& boxes);
    virtual void remove(std::span<const ObjectId> ids);
    virtual void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);

protected:
    CallEncoder() = default;
    CallEncoder(const CallEncoder&) = default;
    CallEncoder& operator=(const CallEncoder&) = default;

    /// Appends a record. Its payload is the concatenation of `pieces`.
    virtual void append(RecordKind kind, std::initializer_list<Bytes> pieces) = 0;

private:
    Bytes packed(std::span<const Traits> traits);

    std::vector<RecordedTraits> traits_;  // buffer of packed()
};

}  // namespace octopair
