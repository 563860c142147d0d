// UploadedCalls: the calls of a scene, read from the pieces in which they come (SceneUpload).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "scene/recording/recording_reader.hpp"

namespace octopair::service {

/// Keeps no more than a record that is not complete, and the piece before it was read.
class UploadedCalls {
public:
    /// Of a record, with what stands around it.
    static constexpr std::uint64_t most_record_bytes = std::uint64_t(2) << 20;

    UploadedCalls() = default;
    UploadedCalls(const UploadedCalls&) = delete;
    UploadedCalls& operator=(const UploadedCalls&) = delete;

    void append(std::span<const std::byte> piece);
    /// The next call that is complete, if there is one. Its spans are valid until anything else here is called. Throws
    /// Error{bad_input} "scene: byte OFFSET: ..." for what is none.
    bool next(RecordedCall& call);
    /// What came ends within a call, or before the scene's options.
    bool cut() const { return !reader_ || end_ > reader_->position(); }
    /// Of the scene; once next() was true.
    const SceneOptions& options() const { return reader_->options(); }

private:
    std::vector<std::byte> kept_;  // the last bytes before end_
    std::uint64_t end_ = 0;        // of all that came
    std::optional<RecordingReader> reader_;
};

}  // namespace octopair::service
