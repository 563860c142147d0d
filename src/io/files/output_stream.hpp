// Where results are written: a file (atomic_file.hpp) or standard output, with a buffer before it.
//
// What is written reaches its place only with commit(); a stream destroyed without it leaves no more than what its kind
// says. Every call throws Error{io_failed} when the system refuses, as on a full disk or a closed pipe (whose SIGPIPE
// and SIGXFSZ the program must ignore).
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

    /// Room for `bytes` (at most max_room) characters, to be filled from the front; advance() says how many were.
    char* room(std::size_t bytes) {
        if (buffer_.size() - used_ < bytes) flush();
        return buffer_.data() + used_;
    }
    void advance(std::size_t bytes) { used_ += bytes; }
    static constexpr std::size_t max_room = 4096;

    void flush();
    /// Flushes, and makes the result final.
    void commit();

private:
    virtual void put(std::span<const std::byte> bytes) = 0;
    virtual void finish() = 0;

    Buffer<char> buffer_;
    std::size_t used_ = 0;
};

/// Standard output. What did not fit the buffer has been written even without commit(). Throws Error{cancelled} within
/// 100 ms of a stop request, also while the reader of a pipe keeps it waiting.
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
