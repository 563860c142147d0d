#include "base/memory.hpp"

#include <cstdint>
#include <cstdlib>
#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace octopair {

namespace {

constexpr std::size_t min_mapped_bytes = std::size_t(1) << 20;
constexpr std::size_t huge_page_bytes = std::size_t(2) << 20;

std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
    if (bytes > std::size_t(-1) - unit) throw std::bad_alloc();
    return (bytes + unit - 1) / unit * unit;
}

#ifdef __linux__

constexpr std::size_t page_bytes = 4096;

/// Maps memory that begins at a multiple of huge_page_bytes if it is large: maps one huge page more, and unmaps the rest.
void* map_pages(std::size_t bytes) {
    const std::size_t size = rounded_up(bytes, page_bytes);
    const std::size_t spare = size < huge_page_bytes ? 0 : huge_page_bytes;
    void* const mapped = ::mmap(nullptr, size + spare, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    if (spare == 0) return mapped;
    char* const begin = static_cast<char*>(mapped);
    const std::size_t before =
        (huge_page_bytes - reinterpret_cast<std::uintptr_t>(begin) % huge_page_bytes) % huge_page_bytes;
    if (before > 0) ::munmap(begin, before);
    if (before < spare) ::munmap(begin + before + size, spare - before);
    return begin + before;
}

/// Requests huge pages, but not for a partial last one: the first access to it would allocate a whole huge page.
void use_huge_pages(void* memory, std::size_t bytes) {
    if (bytes >= huge_page_bytes) (void)::madvise(memory, bytes / huge_page_bytes * huge_page_bytes, MADV_HUGEPAGE);
}

#endif

void* reserve_pages(std::size_t bytes) {
#ifdef __linux__
    if (bytes >= min_mapped_bytes) return map_pages(bytes);
#endif
    constexpr std::size_t alignment = 64;
    void* const memory = std::aligned_alloc(alignment, rounded_up(bytes == 0 ? 1 : bytes, alignment));
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

void commit_pages(void* memory, std::size_t bytes) {
#ifdef __linux__
    use_huge_pages(memory, bytes);
#else
    (void)memory, (void)bytes;
#endif
}

}  // namespace

void* allocate_pages(std::size_t bytes) {
    void* const memory = reserve_pages(bytes);
    commit_pages(memory, bytes);
    return memory;
}

void free_pages(void* memory, std::size_t bytes) noexcept {
#ifdef __linux__
    if (bytes >= min_mapped_bytes) {
        ::munmap(memory, (bytes + page_bytes - 1) / page_bytes * page_bytes);
        return;
    }
#endif
    (void)bytes;
    std::free(memory);
}

namespace {

class OwnPages final : public PageSource {
public:
    void* reserve(std::size_t bytes) override { return reserve_pages(bytes); }
    void commit(void* memory, std::size_t bytes) override { commit_pages(memory, bytes); }
    void free(void* memory, std::size_t bytes) noexcept override { free_pages(memory, bytes); }
};

}  // namespace

PageSource& own_pages() {
    static OwnPages pages;
    return pages;
}

}  // namespace octopair
