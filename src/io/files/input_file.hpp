// InputFile: a regular file, or the copy of a stream (stream_input.hpp), that is open for reading.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>

#include "base/descriptor.hpp"
#include "base/memory.hpp"

namespace octopair::io {

class InputFile {
public:
    /// Throws: Error{io_failed} if the file cannot be opened; Error{bad_input} if it is neither a regular file nor a stream.
    explicit InputFile(std::string path);

    const std::string& path() const { return path_; }
    /// Returns the size in bytes at the time of opening.
    std::uint64_t size() const { return size_; }
    /// Returns the file descriptor, which stays open as long as this object.
    int descriptor() const { return descriptor_.number(); }

    /// Fills `out` with the bytes from `offset` on.
    /// Throws: Error{bad_input} if the file is too short; Error{io_failed}; Error{cancelled} soon after a stop request.
    void read(std::uint64_t offset, std::span<std::byte> out, const std::stop_token& stop = {}) const;

private:
    std::string path_;
    Descriptor descriptor_;
    std::uint64_t size_ = 0;
};

}  // namespace octopair::io
