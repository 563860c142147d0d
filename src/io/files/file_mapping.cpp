#include "io/files/file_mapping.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <mutex>
#include <new>
#include <string>
#include <utility>

#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

/// A mapping. The signal handler reads its atomic members.
struct Mapping {
    std::atomic<std::byte*> begin = nullptr, end = nullptr;  // begins with a page; null if the slot is free
    std::atomic<bool> lost_page = false;                     // the file was shortened, or the disk failed
    Descriptor file;
    FileState state;  // state of the file when it was opened
    std::string path;
};

std::array<Mapping, 64> mappings;
std::mutex mappings_mutex;  // protects the members that are not atomic, and the choice of a slot

std::uintptr_t page_bytes() {
    static const auto bytes = std::uintptr_t(::sysconf(_SC_PAGESIZE));
    return bytes;
}

Mapping* mapping_of(const std::byte* address) {
    for (Mapping& mapping : mappings) {
        if (address >= mapping.begin && address < mapping.end) return &mapping;
    }
    return nullptr;
}

struct sigaction previous_action;  // action of SIGBUS before install_handler()

/// Replaces a page that cannot be read. For any other address, restores the previous action, which handles the signal
/// when the access is repeated.
void handle_lost_page(int, siginfo_t* info, void*) {
    const int error = errno;
    auto* const address = static_cast<std::byte*>(info->si_addr);
    Mapping* const mapping = mapping_of(address);
    std::byte* const page = address - reinterpret_cast<std::uintptr_t>(address) % page_bytes();
    if (mapping != nullptr) mapping->lost_page = true;  // before another thread can read the new page
    const bool replaced = mapping != nullptr && ::mmap(page, page_bytes(), PROT_READ | PROT_WRITE,
                                                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED;
    if (replaced) {
        std::memset(page, 0xFF, page_bytes());
    } else {
        (void)::sigaction(SIGBUS, &previous_action, nullptr);
    }
    errno = error;
}

void install_handler() {
    static const bool installed = [] {
        (void)page_bytes();  // the handler must not be the first to call it
        struct sigaction action {};
        action.sa_sigaction = handle_lost_page;
        action.sa_flags = SA_SIGINFO;
        return ::sigaction(SIGBUS, &action, &previous_action) == 0;
    }();
    (void)installed;
}

class MappedPages final : public PageSource {
public:
    void* reserve(std::size_t) override { throw std::bad_alloc(); }
    void commit(void*, std::size_t) override {}
    void free(void* memory, std::size_t) noexcept override {
        const std::lock_guard lock(mappings_mutex);
        Mapping* const mapping = mapping_of(static_cast<const std::byte*>(memory));
        if (mapping == nullptr) return;
        std::byte* const begin = mapping->begin;
        (void)::munmap(begin, std::size_t(mapping->end - begin));
        mapping->end = nullptr;
        mapping->begin = nullptr;
        mapping->file = Descriptor();
    }
};

}  // namespace

void* map_file(const InputFile& file, std::uint64_t offset, std::size_t bytes) {
    install_handler();
    const std::lock_guard lock(mappings_mutex);
    for (Mapping& mapping : mappings) {
        if (mapping.begin != nullptr) continue;
        Descriptor descriptor(::fcntl(file.descriptor(), F_DUPFD_CLOEXEC, 0));
        if (!descriptor.open()) return nullptr;
        const std::uint64_t in_page = offset % page_bytes();
        void* const memory = ::mmap(nullptr, std::size_t(in_page) + bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE,
                                    file.descriptor(), off_t(offset - in_page));
        if (memory == MAP_FAILED) return nullptr;
        mapping.path = file.path();
        mapping.lost_page = false;
        mapping.file = std::move(descriptor);
        mapping.state = file.state();
        auto* const begin = static_cast<std::byte*>(memory);
        mapping.begin = begin;
        mapping.end = begin + in_page + bytes;
        return begin + in_page;
    }
    return nullptr;
}

PageSource& mapped_pages() {
    static MappedPages pages;
    return pages;
}

bool is_mapped(std::span<const std::byte> memory) { return mapping_of(memory.data()) != nullptr; }

void check_mapping(std::span<const std::byte> memory) {
    const std::lock_guard lock(mappings_mutex);
    const Mapping* const mapping = mapping_of(memory.data());
    if (mapping == nullptr) return;
    mapping->state.check_same_content(FileState::of(mapping->file, mapping->path), mapping->path);
    if (mapping->lost_page) fail_io(mapping->path, "cannot read", EIO);
}

}  // namespace octopair::io
