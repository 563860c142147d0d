// InputFile: a regular file, or the copy of a stream, that is open for reading.
//
// If another program writes to the file while it is open, reading fails, because the content may be partly old and partly new. Another
// program may delete the file, or rename another file over it: the open file keeps its content.
//
// Streams can be read only once: standard input ("-"), pipes, and sockets. Their content is copied into memory when they are
// opened first. Later openings of the same path get the copy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>

#include "base/descriptor.hpp"
#include "base/memory.hpp"

namespace octopair::io {

/// Attributes of an open file that show whether its content has changed.
struct FileState {
    bool regular = false;  ///< false: a directory, stream or device
    std::uint64_t size = 0;
    std::uint64_t links = 0;          ///< number of names in directories
    std::int64_t content_time = 0;    ///< nanoseconds since 1970: last change of the content
    std::int64_t attribute_time = 0;  ///< last change of content, name or attributes. Programs cannot set it

    /// Throws: Error{io_failed} that begins with `path`.
    static FileState of(const Descriptor& file, const std::string& path);
    /// Throws: Error{bad_input} that begins with `path` if the content may have changed between this state and `now`. Does not notice a
    /// change that keeps the size and happens within one tick of the system's clock (4 ms).
    void check_same_content(const FileState& now, const std::string& path) const;
};

class InputFile {
public:
    /// Whether other programs may write to the file while it is open.
    enum class Changes : std::uint8_t { refused, allowed };

    /// Throws: Error{io_failed} if the file cannot be opened; Error{bad_input} if it is neither a regular file nor a stream.
    explicit InputFile(std::string path, Changes changes = Changes::refused);

    const std::string& path() const { return path_; }
    /// Returns the size in bytes at the time of opening.
    std::uint64_t size() const { return state_.size; }
    /// Returns the state at the time of opening.
    const FileState& state() const { return state_; }
    /// Returns the file descriptor, which stays open as long as this object.
    int descriptor() const { return descriptor_.number(); }

    /// Fills `out` with the bytes from `offset` on.
    /// Throws: Error{bad_input} if the file is too short or was changed (check_unchanged()); Error{io_failed}; Error{cancelled} soon
    /// after a stop request.
    void read(std::uint64_t offset, std::span<std::byte> out, const std::stop_token& stop = {}) const;

    /// Throws: Error{bad_input} if another program has changed the content since the file was opened. With Changes::allowed, does
    /// nothing.
    void check_unchanged() const;

private:
    std::string path_;
    Changes changes_;
    Descriptor descriptor_;
    FileState state_;
};

/// Returns whether `path` is "-", or exists and is a pipe, a socket or a terminal.
bool is_stream(const std::string& path);

/// Returns a descriptor of a file in memory with the whole content of a stream. The first call reads the stream to its end; later calls
/// in this process reuse the content.
/// Throws: Error{io_failed, resource_limit}.
/// Thread safety: any thread may call it. Blocks until the writer closes the stream.
Descriptor open_stream_copy(const std::string& path);

}  // namespace octopair::io
