// RecordingReader: reads the calls of a recording (recording.hpp), one after the other.
//
// Invariants
//   A call that is returned has a correct checksum, and the lengths of its arrays match.
//   Boxes and ids are not checked here. The scene that receives the call checks them.
//   Lengths are checked against the size of the file before memory is allocated.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/memory.hpp"
#include "scene/recording/recording.hpp"

namespace octopair {

/// Source of a recording's bytes.
struct RecordingSource {
    std::string name;        ///< name in messages
    std::uint64_t size = 0;  ///< in bytes
    /// Fills `out` with the bytes from `offset` on, which are within `size`. Its exceptions reach the reader's caller.
    std::function<void(std::uint64_t offset, std::span<std::byte> out)> read;
};

/// A call of a recording. `kind` determines which members are set. The spans are valid until the reader's next call.
struct RecordedCall {
    RecordKind kind = RecordKind::step;
    std::uint64_t offset = 0;  ///< offset of its record in the file, in bytes
    std::span<const ObjectId> ids;
    Objects objects;
    std::span<const Traits> traits;
    RecordedResult result;
};

/// Throws: Error{bad_input} "NAME: byte OFFSET: ..." if the bytes are not a valid recording, or are of a newer version.
class RecordingReader {
public:
    explicit RecordingReader(RecordingSource source);

    /// Returns the precision and margin of the scene.
    const SceneOptions& options() const { return options_; }
    const std::string& name() const { return source_.name; }
    /// Reads the next call. Returns false at the end of the source, also if the last record is truncated (cut()).
    bool next(RecordedCall& call);
    /// Sets a larger size of the source. A record that was truncated may then be complete.
    void grow(std::uint64_t size) { source_.size = size; }
    /// Returns the offset of the next call, in bytes. Bytes before it are not read again.
    std::uint64_t position() const { return at_; }
    /// Returns whether the source ends within a record. Valid after next() has returned false.
    bool cut() const { return cut_; }
    /// Returns the fraction of the source that has been read, from 0 to 1.
    double progress() const { return double(at_) / double(source_.size); }

    /// Throws: Error{bad_input} with the name of the source and the offset.
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
    // Arrays of the current call, copied from payload_ for the right alignment.
    Buffer<ObjectId> ids_;
    Buffer<Box3f> boxes32_;
    Buffer<Box3d> boxes64_;
    Buffer<double> paddings_;
    Buffer<RecordedTraits> packed_;
    std::vector<Traits> traits_;
};

}  // namespace octopair
