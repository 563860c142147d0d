#include "io/files/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>

#include "io/files/failure.hpp"
#include "io/files/stream_input.hpp"

namespace octopair::io {

namespace {

constexpr const char* truncated = "the file was truncated while it was read";

std::int64_t nanoseconds(const timespec& time) { return std::int64_t(time.tv_sec) * 1'000'000'000 + time.tv_nsec; }

}  // namespace

FileState FileState::of(const Descriptor& file, const std::string& path) {
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail_io(path, "cannot read", errno);
    return {S_ISREG(status.st_mode), std::uint64_t(status.st_size), std::uint64_t(status.st_nlink),
            nanoseconds(status.st_mtim), nanoseconds(status.st_ctim)};
}

void FileState::check_same_content(const FileState& now, const std::string& path) const {
    if (now.size < size) refuse(path, truncated);
    // Adding or removing a name changes the attribute time, too. So this time counts only if the number of names is the same.
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

}  // namespace octopair::io
