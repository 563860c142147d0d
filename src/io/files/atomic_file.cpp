#include "io/files/atomic_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <random>

#include <fmt/format.h>

#include "base/free_memory.hpp"
#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

namespace fs = std::filesystem;

/// Follows symbolic links. The target of the last link need not exist.
fs::path resolved(const std::string& path) {
    fs::path at(path);
    std::error_code error;
    for (int links = 0; links < 40 && fs::is_symlink(at, error); ++links) {
        const fs::path target = fs::read_symlink(at, error);
        if (error) break;
        at = at.parent_path() / target;
    }
    return at;
}

std::string directory_of(const fs::path& path) {
    return path.parent_path().empty() ? "." : path.parent_path().string();
}

/// Returns the free bytes of the file system that contains `directory`. Returns nothing if the number is unknown, or if the file system,
/// or the server of a network file system, can compress files.
std::optional<std::uint64_t> free_space(const std::string& directory) {
    // btrfs, bcachefs, F2FS, ZFS, NFS, SMB, SMB 2. Their numbers are not in a header of all systems.
    constexpr std::array<std::uint32_t, 7> compressing = {0x9123683E, 0xCA451A4E, 0xF2F52010, 0x2FC12FC1,
                                                          0x6969,     0xFF534D42, 0xFE534D42};
    struct statfs status {};
    if (::statfs(directory.c_str(), &status) != 0 || status.f_blocks == 0) return {};
    if (std::ranges::find(compressing, std::uint32_t(status.f_type)) != compressing.end()) return {};
    // As in df(1), blocks that are reserved for the superuser do not count.
    return std::uint64_t(status.f_bavail) * std::uint64_t(status.f_frsize > 0 ? status.f_frsize : status.f_bsize);
}

std::string random_name(const std::string& directory) {
    std::random_device random;
    return fmt::format("{}/.octopair-{:08x}{:08x}.tmp", directory, random(), random());
}

void write_whole(const Descriptor& file, const std::string& path, std::span<const std::byte> bytes,
                 std::uint64_t offset) {
    while (!bytes.empty()) {
        const ssize_t written = ::pwrite(file.number(), bytes.data(), bytes.size(), off_t(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_io(path, "cannot write", errno);
        offset += std::uint64_t(written);
        bytes = bytes.subspan(std::size_t(written));
    }
}

/// Returns whether a path is standard output, a pipe, a device or a socket.
bool is_output_stream(const std::string& path) {
    if (path == "-") return true;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return false;
    return S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode) || S_ISSOCK(status.st_mode);
}

Descriptor open_output_stream(const std::string& path) {
    if (path == "-") return Descriptor(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0));
    return Descriptor(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
}

std::string own_link(int descriptor) { return fmt::format("/proc/self/fd/{}", descriptor); }

}  // namespace

std::optional<FileRoom> room_for_file(const std::string& path) {
    const auto space = is_output_stream(path) ? free_memory() : free_space(directory_of(resolved(path)));
    rlimit limit{};
    const bool limited = ::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
    if (limited && (!space || limit.rlim_cur < *space))
        return FileRoom{limit.rlim_cur, "are allowed for a file (ulimit -f)"};
    if (!space) return {};
    return FileRoom{*space, is_output_stream(path) ? "of memory are free" : "are free on its file system"};
}

AtomicFile::AtomicFile(const std::string& path) {
    if (is_output_stream(path)) {
        path_ = path;
        stream_ = open_output_stream(path);
        descriptor_ = Descriptor(::memfd_create("octopair", MFD_CLOEXEC));
        if (!stream_.open() || !descriptor_.open()) fail_io(path_, "cannot open", errno);
        return;
    }
    choose_place(path);
    open_unnamed();
    if (!descriptor_.open()) open_named();
}

AtomicFile::AtomicFile(const std::string& path, Shared) {
    choose_place(path);
    open_named();
}

void AtomicFile::choose_place(const std::string& path) {
    const fs::path target = resolved(path);
    path_ = target.string();
    directory_ = directory_of(target);
    struct stat status {};
    if (::stat(path_.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
        fail_io(path, "cannot be replaced, it is not a regular file", S_ISDIR(status.st_mode) ? EISDIR : EEXIST);
    }
    if (target.filename().empty()) fail_io(path, "cannot create", EISDIR);
}

AtomicFile::~AtomicFile() { remove_temporary(); }

void AtomicFile::open_unnamed() {
#ifdef O_TMPFILE
    descriptor_ = Descriptor(::open(directory_.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666));
    // give_name() needs /proc, which may not be mounted.
    if (descriptor_.open() && ::access(own_link(descriptor_.number()).c_str(), F_OK) != 0) descriptor_ = Descriptor();
#endif
}

void AtomicFile::open_named() {
    do {
        temporary_ = random_name(directory_);
        descriptor_ = Descriptor(::open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666));
    } while (!descriptor_.open() && errno == EEXIST);
    if (descriptor_.open()) return;
    const int error = errno;
    temporary_.clear();
    fail_io(path_, "cannot create", error);
}

void AtomicFile::give_name() {
    if (!temporary_.empty()) return;
    const std::string link = own_link(descriptor_.number());
    int result = 0;
    std::string name;
    do {
        name = random_name(directory_);
        result = ::linkat(AT_FDCWD, link.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW);
    } while (result != 0 && errno == EEXIST);
    if (result != 0) fail_io(path_, "cannot create", errno);
    temporary_ = name;
}

void AtomicFile::remove_temporary() noexcept {
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    temporary_.clear();
}

void AtomicFile::put(std::span<const std::byte> bytes) {
    write_all(bytes, end_);
    end_ += bytes.size();
}

void AtomicFile::write_at(std::uint64_t offset, std::string_view text) {
    flush();
    write_all(std::as_bytes(std::span(text)), offset);
}

void AtomicFile::write_all(std::span<const std::byte> bytes, std::uint64_t offset) {
    write_whole(descriptor_, path_, bytes, offset);
}

/// Gives the temporary file the mode of the file that it replaces and, where the system allows it, the owner.
void AtomicFile::keep_attributes() const {
    struct stat old {};
    if (::stat(path_.c_str(), &old) != 0) return;
    (void)!::fchown(descriptor_.number(), old.st_uid, gid_t(-1));
    const bool same_group = ::fchown(descriptor_.number(), uid_t(-1), old.st_gid) == 0;
    const mode_t group = same_group ? 0070 : 0;  // rights of the old group are not for another group
    (void)::fchmod(descriptor_.number(), old.st_mode & (0707 | group));
}

void AtomicFile::copy_to_stream() {
    std::array<std::byte, 1 << 16> piece;
    for (off_t at = 0;;) {
        const ssize_t got = ::pread(descriptor_.number(), piece.data(), piece.size(), at);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail_io(path_, "cannot read its copy", errno);
        if (got == 0) return;
        at += got;
        for (std::span bytes(piece.data(), std::size_t(got)); !bytes.empty();) {
            const ssize_t written = ::write(stream_.number(), bytes.data(), bytes.size());
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) fail_io(path_, "cannot write", errno);
            bytes = bytes.subspan(std::size_t(written));
        }
    }
}

void AtomicFile::finish() {
    if (stream_.open()) return copy_to_stream();
    keep_attributes();
    if (::fsync(descriptor_.number()) != 0) fail_io(path_, "cannot write", errno);
    give_name();
    if (descriptor_.close() != 0) fail_io(path_, "cannot write", errno);
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail_io(path_, "cannot rename onto it", errno);
    temporary_.clear();
    const Descriptor directory(::open(directory_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    // Errors are ignored: the result is complete, and some file systems cannot sync a directory.
    if (directory.open()) (void)::fsync(directory.number());
}

FilePart::FilePart(const std::string& temporary, const std::string& path)
    : path_(path), descriptor_(::open(temporary.c_str(), O_WRONLY | O_CLOEXEC)) {
    if (!descriptor_.open()) fail_io(path_, "cannot open", errno);
}

void FilePart::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
    write_whole(descriptor_, path_, bytes, offset);
}

void FilePart::sync() {
    if (::fsync(descriptor_.number()) != 0) fail_io(path_, "cannot write", errno);
}

}  // namespace octopair::io
