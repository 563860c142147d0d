// CallEncoder: the calls of a scene as records (recording.hpp), wherever these go.
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "scene/recording/recording.hpp"

namespace octopair {

/// What stands around the payload of a record.
struct RecordFrame {
    RecordHead head;
    std::uint64_t checksum;
};

/// `pieces`: of the payload.
RecordFrame frame_of(RecordKind kind, std::initializer_list<Bytes> pieces);

class CallEncoder {
public:
    virtual ~CallEncoder() = default;

    /// All throw what append() throws, and Error{resource_limit} for more objects than a record can have.
    virtual void add(const Objects& objects, std::span<const Traits> traits);
    /// `kind`: move or sweep.
    virtual void move(RecordKind kind, std::span<const ObjectId> ids, const Boxes& boxes);
    virtual void remove(std::span<const ObjectId> ids);
    virtual void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);

protected:
    CallEncoder() = default;
    CallEncoder(const CallEncoder&) = default;
    CallEncoder& operator=(const CallEncoder&) = default;

    /// One record more.
    virtual void append(RecordKind kind, std::initializer_list<Bytes> pieces) = 0;

private:
    Bytes packed(std::span<const Traits> traits);

    std::vector<RecordedTraits> traits_;  // of a call
};

}  // namespace octopair
