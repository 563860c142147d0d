// RecordingReader: the calls in a recording (recording.hpp), one after the other.
//
// What it returns has the right checksum and arrays that fit each other; whether boxes are boxes and ids are of objects, the
// scene says to which the call is made. Lengths are held against the size of the file before memory is taken.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/memory.hpp"
#include "scene/recording/recording.hpp"

namespace octopair {

/// The bytes of a recording, wherever they are.
struct RecordingSource {
    std::string name;        ///< in messages
    std::uint64_t size = 0;  ///< in bytes
    /// Fills `out` from `offset` on; asked within the size only. What it throws reaches the caller.
    std::function<void(std::uint64_t offset, std::span<std::byte> out)> read;
};

/// Which members hold something depends on the kind. The spans are valid until the reader's next call.
struct RecordedCall {
    RecordKind kind = RecordKind::step;
    std::uint64_t offset = 0;  ///< of its record in the file
    std::span<const ObjectId> ids;
    Objects objects;
    std::span<const Traits> traits;
    RecordedResult result;
};

/// Throws Error{bad_input} "NAME: byte OFFSET: ..." for what no recorder wrote, or one of a newer version did.
class RecordingReader {
public:
    explicit RecordingReader(RecordingSource source);

    /// The precision and margin of the scene.
    const SceneOptions& options() const { return options_; }
    const std::string& name() const { return source_.name; }
    /// The next call; false at the end, and where the last record was cut.
    bool next(RecordedCall& call);
    /// The source is longer than it was: what was cut may be whole now.
    void grow(std::uint64_t size) { source_.size = size; }
    /// Where the next call begins; what lies before is not read again.
    std::uint64_t position() const { return at_; }
    /// The file ends within a record.
    bool cut() const { return cut_; }
    /// How much of the file is read, from 0 to 1.
    double progress() const { return double(at_) / double(source_.size); }

    /// Throws Error{bad_input} that names the file and the place.
    [[noreturn]] void refuse(std::uint64_t offset, const std::string& what) const;

private:
    class Payload;

    void read_head();
    void parse(RecordedCall& call);
    void parse_objects(Payload& payload, RecordedCall& call);
    void parse_boxes(Payload& payload, std::uint32_t count, RecordedCall& call);
    void parse_ids(Payload& payload, std::uint32_t count, RecordedCall& call);
    void parse_traits(Payload& payload, std::uint32_t count, RecordedCall& call);
    std::uint64_t box_bytes() const;

    RecordingSource source_;
    SceneOptions options_;
    std::uint64_t at_ = 0;
    bool cut_ = false;
    Buffer<std::byte> payload_;
    // Of the call, where their alignment is right.
    Buffer<ObjectId> ids_;
    Buffer<Box3f> boxes32_;
    Buffer<Box3d> boxes64_;
    Buffer<double> paddings_;
    Buffer<RecordedTraits> packed_;
    std::vector<Traits> traits_;
};

}  // namespace octopair
