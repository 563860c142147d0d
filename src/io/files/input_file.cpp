#include "io/files/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>

#include "io/files/failure.hpp"
#include "io/files/stream_input.hpp"

namespace octopair::io {

InputFile::InputFile(std::string path) : path_(std::move(path)) {
    // With O_NONBLOCK, opening a device does not block; the check below then refuses it. The flag has no effect on a regular file.
    descriptor_ = is_stream(path_) ? open_stream_copy(path_)
                                   : Descriptor(::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!descriptor_.open()) fail_io(path_, "cannot open", errno);
    struct stat status {};
    if (::fstat(descriptor_.number(), &status) != 0) fail_io(path_, "cannot read", errno);
    if (!S_ISREG(status.st_mode)) refuse(path_, "not a regular file");
    size_ = std::uint64_t(status.st_size);
}

void InputFile::read(std::uint64_t offset, std::span<std::byte> out, const std::stop_token& stop) const {
    constexpr std::size_t piece = std::size_t(32) << 20;  // takes a few ms, so a stop request is seen soon
    while (!out.empty()) {
        if (stop.stop_requested()) cancel();
        const ssize_t got = ::pread(descriptor_.number(), out.data(), std::min(piece, out.size()), off_t(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail_io(path_, "cannot read", errno);
        if (got == 0) refuse(path_, "the file was truncated while it was read");
        offset += std::uint64_t(got);
        out = out.subspan(std::size_t(got));
    }
}

}  // namespace octopair::io
