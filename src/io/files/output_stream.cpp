#include "io/files/output_stream.hpp"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "io/files/failure.hpp"

namespace octopair::io {

OutputStream::OutputStream() : buffer_(std::size_t(256) << 10) {}

void OutputStream::write(std::span<const std::byte> bytes) {
    if (bytes.size() > buffer_.size() - used_) flush();
    if (bytes.size() > buffer_.size()) return put(bytes);
    if (bytes.empty()) return;
    std::memcpy(buffer_.data() + used_, bytes.data(), bytes.size());
    used_ += bytes.size();
}

void OutputStream::flush() {
    const auto bytes = std::as_bytes(buffer_.span().first(used_));
    used_ = 0;
    if (!bytes.empty()) put(bytes);
}

void OutputStream::commit() {
    flush();
    finish();
}

StandardOutput::StandardOutput(std::stop_token stop) : stop_(std::move(stop)) {
    struct stat status {};
    may_block_ = ::fstat(STDOUT_FILENO, &status) != 0 || !S_ISREG(status.st_mode);
}

void StandardOutput::put(std::span<const std::byte> bytes) {
    // After poll() reports a pipe as writable, writing up to PIPE_BUF bytes does not block. So a stop request is always seen.
    constexpr std::size_t piece = 4096;
    while (!bytes.empty()) {
        if (stop_.stop_requested()) cancel();
        if (may_block_) {
            pollfd waiting{STDOUT_FILENO, POLLOUT, 0};
            const int ready = ::poll(&waiting, 1, 100);
            if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
        }
        const std::size_t size = may_block_ ? std::min(piece, bytes.size()) : bytes.size();
        const ssize_t written = ::write(STDOUT_FILENO, bytes.data(), size);
        if (written < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (written < 0) fail_io("standard output", "cannot write", errno);
        bytes = bytes.subspan(std::size_t(written));
    }
}

}  // namespace octopair::io
