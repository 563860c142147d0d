// A regular file, open for reading. It is read, never mapped, so that a file which shrinks meanwhile is an error and
// not a SIGBUS.
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
    /// Throws Error{io_failed} if it cannot be opened, Error{bad_input} if it is not a regular file.
    explicit InputFile(std::string path);

    const std::string& path() const { return path_; }
    /// In bytes, when it was opened.
    std::uint64_t size() const { return size_; }

    /// Fills `out` from `offset` on. Throws Error{bad_input} if the file ends before, Error{io_failed}, and
    /// Error{cancelled} soon after a stop request.
    void read(std::uint64_t offset, std::span<std::byte> out, const std::stop_token& stop = {}) const;

private:
    std::string path_;
    Descriptor descriptor_;
    std::uint64_t size_ = 0;
};

}  // namespace octopair::io
