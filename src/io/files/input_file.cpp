#include "io/files/input_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <map>
#include <mutex>

#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

constexpr const char* truncated = "the file was truncated while it was read";

std::int64_t nanoseconds(const timespec& time) { return std::int64_t(time.tv_sec) * 1'000'000'000 + time.tv_nsec; }

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

FileState FileState::of(const Descriptor& file, const std::string& path) {
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail_io(path, "cannot read", errno);
    return {S_ISREG(status.st_mode), std::uint64_t(status.st_size), std::uint64_t(status.st_nlink),
            nanoseconds(status.st_mtim), nanoseconds(status.st_ctim)};
}

void FileState::check_same_content(const FileState& now, const std::string& path) const {
    if (now.size < size) refuse(path, truncated);
    // Adding or removing a name changes the attribute time, too. So the attribute time counts only if the number of names is equal.
    const bool same = now.size == size && now.content_time == content_time &&
                      (now.attribute_time == attribute_time || now.links != links);
    if (!same) refuse(path, "the file changed while it was read; run again when no program writes to it");
}

InputFile::InputFile(std::string path, Changes changes) : path_(std::move(path)), changes_(changes) {
    // With O_NONBLOCK, opening a device does not block; the check below then refuses it. The flag has no effect on a regular file.
    descriptor_ = is_stream(path_) ? open_stream_copy(path_)
                                   : Descriptor(::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!descriptor_.open()) fail_io(path_, "cannot open", errno);
    state_ = FileState::of(descriptor_, path_);
    if (!state_.regular) refuse(path_, "not a regular file");
}

void InputFile::check_unchanged() const {
    if (changes_ == Changes::refused) state_.check_same_content(FileState::of(descriptor_, path_), path_);
}

void InputFile::read(std::uint64_t offset, std::span<std::byte> out, const std::stop_token& stop) const {
    constexpr std::size_t piece = std::size_t(32) << 20;  // takes a few ms, so a stop request is seen soon
    while (!out.empty()) {
        if (stop.stop_requested()) cancel();
        const ssize_t got = ::pread(descriptor_.number(), out.data(), std::min(piece, out.size()), off_t(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail_io(path_, "cannot read", errno);
        if (got == 0) refuse(path_, truncated);
        offset += std::uint64_t(got);
        out = out.subspan(std::size_t(got));
    }
    check_unchanged();
}

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
