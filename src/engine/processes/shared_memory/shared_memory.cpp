#include "engine/processes/shared_memory/shared_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr std::uint64_t page = 4096;
constexpr int seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

[[noreturn]] void throw_exhausted(const char* what, int error) {
    throw Error(ErrorCode::resource_limit, std::string("shared memory: ") + what + ": " + std::strerror(error));
}

std::uint64_t soft_limit(decltype(RLIMIT_AS) resource) {
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return ~std::uint64_t(0);
    return limit.rlim_cur;
}

template <typename Call>
int retried(Call&& call) {
    int result = 0;
    do {
        result = call();
    } while (result != 0 && errno == EINTR);
    return result;
}

/// Creates the file. Some systems require the flag that makes it not executable. If an older kernel rejects this flag, creates the file
/// without it.
Descriptor create_file() {
    constexpr unsigned flags = MFD_CLOEXEC | MFD_ALLOW_SEALING;
    constexpr unsigned not_executable = 8;  // MFD_NOEXEC_SEAL of Linux 6.3, which not all headers have
    Descriptor file(::memfd_create("octopair", flags | not_executable));
    if (!file.open() && errno == EINVAL) file = Descriptor(::memfd_create("octopair", flags));
    if (!file.open()) throw_exhausted("cannot create the file", errno);
    return file;
}

}  // namespace

std::uint64_t max_region_bytes() {
    const auto memory = std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE));
    // Several such files are mapped at the same time, so each may use an eighth of the RLIMIT_AS limit.
    const std::uint64_t most = std::min({memory, soft_limit(RLIMIT_FSIZE), soft_limit(RLIMIT_AS) / 8});
    return std::max(page, most / page * page);
}

SharedMemory SharedMemory::create(std::uint64_t bytes) {
    // Above this limit ftruncate() would not only fail, but also raise SIGXFSZ, which ends the process.
    if (bytes > soft_limit(RLIMIT_FSIZE)) throw_exhausted("the size exceeds the limit of files (ulimit -f)", EFBIG);
    Descriptor file = create_file();
    if (retried([&] { return ::ftruncate(file.number(), off_t(bytes)); }) != 0)
        throw_exhausted("cannot set the size of the file", errno);
    if (::fcntl(file.number(), F_ADD_SEALS, seals) != 0) throw_exhausted("cannot seal the file", errno);
    return {std::move(file), bytes};
}

SharedMemory SharedMemory::open(Descriptor file, std::uint64_t bytes) {
    struct stat status {};
    const bool valid = ::fstat(file.number(), &status) == 0 && std::uint64_t(status.st_size) == bytes &&
                       (::fcntl(file.number(), F_GET_SEALS) & seals) == seals;
    if (!valid)
        throw Error(ErrorCode::engine_failed, "shared memory: the received file has the wrong size or is not sealed");
    return {std::move(file), bytes};
}

SharedMemory::SharedMemory(Descriptor file, std::uint64_t bytes)
    : file_(std::move(file)), size_(bytes), committed_(std::size_t((bytes + granule - 1) / granule), false) {
    void* const mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, file_.number(), 0);
    if (mapped == MAP_FAILED) throw_exhausted("cannot map the file", errno);
    data_ = static_cast<std::byte*>(mapped);
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : file_(std::move(other.file_)),
      size_(std::exchange(other.size_, 0)),
      data_(std::exchange(other.data_, nullptr)),
      committed_(std::move(other.committed_)) {}

SharedMemory::~SharedMemory() {
    if (data_ != nullptr) ::munmap(data_, size_);
}

std::uint64_t SharedMemory::committed_bytes() const {
    constexpr std::uint64_t unit = 512;  // of st_blocks
    struct stat status {};
    return ::fstat(file_.number(), &status) == 0 ? std::uint64_t(status.st_blocks) * unit : 0;
}

void SharedMemory::refuse(std::uint64_t bytes) const {
    throw Error(ErrorCode::resource_limit,
                "shared memory: " + std::to_string(bytes) + " more bytes do not fit into " + std::to_string(size_));
}

void SharedMemory::commit(std::uint64_t offset, std::uint64_t bytes) {
    if (bytes == 0) return;
    if (offset > size_ || bytes > size_ - offset) refuse(bytes);
    const std::uint64_t end = (offset + bytes + granule - 1) / granule;
    const std::lock_guard lock(mutex_);
    for (std::uint64_t i = offset / granule; i < end; ++i) {
        if (committed_[i]) continue;
        std::uint64_t last = i;
        while (last < end && !committed_[last]) ++last;
        commit_granules(i, last);
        i = last;
    }
}

void SharedMemory::commit_granules(std::uint64_t begin, std::uint64_t end) {
    const std::uint64_t offset = begin * granule;
    const std::uint64_t bytes = std::min(end * granule, size_) - offset;
    // Commit in pieces of 1 MiB: a call that a signal interrupts starts again from the begin of its piece.
    constexpr std::uint64_t piece = 1 << 20;
    for (std::uint64_t at = offset; at < offset + bytes; at += piece) {
        const auto size = off_t(std::min(piece, offset + bytes - at));
        if (retried([&] { return ::fallocate(file_.number(), 0, off_t(at), size); }) != 0) {
            throw_exhausted("cannot commit more memory", errno);
        }
    }
#ifdef MADV_POPULATE_WRITE
    // Map the pages now, not one by one at first access. Kernels without this call map them at first access.
    const int error = ::madvise(data_ + offset, bytes, MADV_POPULATE_WRITE) == 0 ? 0 : errno;
    if (error == ENOMEM || error == EFAULT) throw_exhausted("cannot map the file", error);
#endif
    for (std::uint64_t i = begin; i < end; ++i) committed_[i] = true;
}

void* Arena::reserve(std::size_t bytes) {
    if (bytes > memory_.size() - used_) {
        throw Error(ErrorCode::resource_limit, "shared memory: " + std::to_string(bytes) +
                                                   " more bytes do not fit into " + std::to_string(memory_.size()));
    }
    void* const reserved = memory_.data() + used_;
    used_ = std::min(memory_.size(), (used_ + bytes + page - 1) / page * page);  // arrays never share a page
    return reserved;
}

}  // namespace octopair
