// CallEncoder: encodes the calls of a scene as records (recording.hpp). Derived classes store or send the records.
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "base/private_export.hpp"
#include "scene/recording/recording.hpp"

namespace octopair {

/// The parts of a record before and after its payload.
struct RecordEnvelope {
    RecordHead head;
    std::uint64_t checksum;
};

/// Returns the envelope of a record. Its payload is the concatenation of `pieces`.
OCTOPAIR_PRIVATE_EXPORT RecordEnvelope envelope_of(RecordKind kind, std::initializer_list<Bytes> pieces);

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
