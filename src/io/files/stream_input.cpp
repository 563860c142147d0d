#include "io/files/stream_input.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <map>
#include <mutex>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"

namespace octopair::io {

namespace {

constexpr const char* standard_input = "-";

Descriptor open_stream(const std::string& path) {
    if (path == standard_input) return Descriptor(::dup(STDIN_FILENO));
    // With O_NONBLOCK, opening a pipe without a writer does not block. So poll() waits for the writer instead.
    return Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
}

void write_all(const Descriptor& to, const std::string& path, const char* bytes, std::size_t size) {
    while (size > 0) {
        const ssize_t written = ::write(to.number(), bytes, size);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_io(path, "cannot copy into memory", errno);
        bytes += written;
        size -= std::size_t(written);
    }
}

Descriptor copy_of(const std::string& path) {
    const Descriptor from = open_stream(path);
    if (!from.open()) fail_io(path, "cannot open", errno);
    const FileState before = FileState::of(from, path);
    Descriptor copy(::memfd_create("octopair", MFD_CLOEXEC));
    if (!copy.open()) fail_io(path, "cannot copy into memory", errno);
    std::array<char, 1 << 16> piece;
    for (;;) {
        pollfd waiting{from.number(), POLLIN, 0};
        if (::poll(&waiting, 1, -1) < 0 && errno != EINTR) fail_io(path, "cannot read", errno);
        const ssize_t got = ::read(from.number(), piece.data(), piece.size());
        if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (got < 0) fail_io(path, "cannot read", errno);
        if (got == 0) break;
        write_all(copy, path, piece.data(), std::size_t(got));
    }
    if (before.regular) before.check_same_content(FileState::of(from, path), path);
    return copy;
}

}  // namespace

bool is_stream(const std::string& path) {
    if (path == standard_input) return true;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return false;
    if (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode)) return true;
    if (!S_ISCHR(status.st_mode)) return false;
    const Descriptor device(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    return device.open() && ::isatty(device.number()) == 1;
}

Descriptor open_stream_copy(const std::string& path) {
    static std::mutex mutex;
    static std::map<std::string, Descriptor> copies;
    const std::lock_guard lock(mutex);
    auto known = copies.find(path);
    if (known == copies.end()) known = copies.emplace(path, copy_of(path)).first;
    Descriptor again(::fcntl(known->second.number(), F_DUPFD_CLOEXEC, 0));
    if (!again.open()) fail_io(path, "cannot open", errno);
    return again;
}

}  // namespace octopair::io
