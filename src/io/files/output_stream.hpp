// OutputStream: a buffered destination of results, which is a file (atomic_file.hpp) or standard output.
//
// - The result is complete only after commit(). Each subclass says what remains of a stream without commit().
// - Every call throws Error{io_failed} if the system refuses, for example on a full disk or a closed pipe.
// - Requires: the program ignores SIGPIPE and SIGXFSZ.
#pragma once

#include <cstddef>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include "base/memory.hpp"

namespace octopair::io {

class OutputStream {
public:
    OutputStream();
    OutputStream(const OutputStream&) = delete;
    OutputStream& operator=(const OutputStream&) = delete;
    virtual ~OutputStream() = default;

    void write(std::span<const std::byte> bytes);
    void write(std::string_view text) { write(std::as_bytes(std::span(text))); }

    /// Returns space for `bytes` characters in the buffer. The caller fills a prefix of it and passes its length to advance().
    /// Requires: bytes <= 4096.
    char* room(std::size_t bytes) {
        if (buffer_.size() - used_ < bytes) flush();
        return buffer_.data() + used_;
    }
    void advance(std::size_t bytes) { used_ += bytes; }

    void flush();
    /// Flushes the buffer, and makes the result final.
    void commit();

private:
    virtual void put(std::span<const std::byte> bytes) = 0;
    virtual void finish() = 0;

    Buffer<char> buffer_;
    std::size_t used_ = 0;
};

/// Standard output. Without commit(), only the content of the buffer is lost.
/// Throws: Error{cancelled} within 100 ms of a stop request, even while a pipe is full.
class StandardOutput final : public OutputStream {
public:
    explicit StandardOutput(std::stop_token stop);

private:
    void put(std::span<const std::byte> bytes) override;
    void finish() override {}

    std::stop_token stop_;
    bool may_block_;
};

}  // namespace octopair::io
