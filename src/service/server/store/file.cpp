#include "service/server/store/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"
#include "service/server/jobs/job_record.hpp"

namespace octopair::service {

namespace {

/// Throws: as fail_io(); NoRoomError if the disk is full.
[[noreturn]] void fail(const std::string& path, const char* action, int error_number) {
    if (error_number == ENOSPC || error_number == EDQUOT) {
        throw NoRoomError(name_of_file(path) + ": " + action + ": " + std::generic_category().message(error_number));
    }
    fail_io(name_of_file(path), action, error_number);
}

}  // namespace

std::string name_of_file(const std::string& path) { return path.substr(path.rfind('/') + 1); }

File::File(std::string path, Mode mode) : path_(std::move(path)) {
    const int flags = mode == Mode::read ? O_RDONLY : O_RDWR | O_CREAT | O_EXCL;
    // With O_NONBLOCK, opening a pipe does not wait for its other end.
    descriptor_ = Descriptor(::open(path_.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600));
    if (!descriptor_.open()) fail(path_, mode == Mode::read ? "cannot open" : "cannot create", errno);
    struct stat status {};
    if (::fstat(descriptor_.number(), &status) != 0 || !S_ISREG(status.st_mode))
        throw Error(ErrorCode::io_failed, name() + ": damaged: it is not a regular file");
}

std::uint64_t File::size() const {
    struct stat status {};
    if (::fstat(descriptor_.number(), &status) != 0) fail(path_, "cannot read", errno);
    return std::uint64_t(status.st_size);
}

void File::read(std::uint64_t offset, std::span<std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t count = ::pread(descriptor_.number(), bytes.data(), bytes.size(), off_t(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path_, "cannot read", errno);
        if (count == 0) throw Error(ErrorCode::io_failed, name() + ": damaged: the file is too short");
        offset += std::uint64_t(count);
        bytes = bytes.subspan(std::size_t(count));
    }
}

void File::write(std::uint64_t offset, std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t count = ::pwrite(descriptor_.number(), bytes.data(), bytes.size(), off_t(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path_, "cannot write", errno);
        offset += std::uint64_t(count);
        bytes = bytes.subspan(std::size_t(count));
    }
}

void File::reserve(std::uint64_t bytes) const {
    int result = 0;
    do {
        result = ::fallocate(descriptor_.number(), FALLOC_FL_KEEP_SIZE, 0, off_t(bytes));
    } while (result != 0 && errno == EINTR);
    if (result != 0 && errno != EOPNOTSUPP && errno != ENOSYS) fail(path_, "cannot write", errno);
}

void File::finish(const std::string& path) const {
    if (::fsync(descriptor_.number()) != 0) fail(path_, "cannot write", errno);
    if (::rename(path_.c_str(), path.c_str()) != 0) fail(path, "cannot rename onto it", errno);
    if (!sync_folder_of(path)) fail(path, "cannot sync its folder", errno);
}

bool remove_file(const std::string& path) noexcept { return ::unlink(path.c_str()) == 0; }

bool sync_folder_of(const std::string& path) noexcept {
    const std::size_t slash = path.rfind('/');
    char folder[4096] = ".";
    if (slash != std::string::npos) {
        const int length =
            std::snprintf(folder, sizeof folder, "%.*s", int(std::max<std::size_t>(slash, 1)), path.c_str());
        if (length < 0 || std::size_t(length) >= sizeof folder) return false;
    }
    const Descriptor descriptor(::open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!descriptor.open()) return false;
    // Some file systems cannot sync folders.
    return ::fsync(descriptor.number()) == 0 || errno == EINVAL || errno == ENOTSUP;
}

}  // namespace octopair::service
