// UploadedCalls: reads the calls of a scene from the pieces of a recording that SceneUpload messages carry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "scene/recording/recording_reader.hpp"

namespace octopair::service {

/// Memory: at most one incomplete record and the piece that was appended last.
class UploadedCalls {
public:
    /// Maximum size of a record, with its head and checksum.
    static constexpr std::uint64_t max_record_bytes = std::uint64_t(2) << 20;

    UploadedCalls() = default;
    UploadedCalls(const UploadedCalls&) = delete;
    UploadedCalls& operator=(const UploadedCalls&) = delete;

    void append(std::span<const std::byte> piece);
    /// Reads the next complete call into `call` and returns true, or returns false if more bytes are needed. The spans of
    /// `call` are valid until the next call of a member function. Throws: Error{bad_input} "scene: byte OFFSET: ..." for
    /// invalid bytes.
    bool next(RecordedCall& call);
    /// Returns whether the received bytes end within a call, or before the end of the scene's options.
    bool is_incomplete() const { return !reader_ || end_ > reader_->position(); }
    /// Returns the options of the scene. Requires: next() has returned true.
    const SceneOptions& options() const { return reader_->options(); }

private:
    std::vector<std::byte> kept_;  // the last received bytes, up to offset end_
    std::uint64_t end_ = 0;        // number of bytes received
    std::optional<RecordingReader> reader_;
};

}  // namespace octopair::service
