#include "base/memory.hpp"

#include <cstdint>
#include <cstdlib>
#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace octopair {

namespace {

constexpr std::size_t mapped_from = std::size_t(1) << 20;  // bytes
constexpr std::size_t huge_page = std::size_t(2) << 20;

std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
    if (bytes > std::size_t(-1) - unit) throw std::bad_alloc();
    return (bytes + unit - 1) / unit * unit;
}

#ifdef __linux__

constexpr std::size_t page = 4096;

/// Maps a huge page more than is asked, and gives back what does not lie on them.
void* map_pages(std::size_t bytes) {
    const std::size_t size = rounded_up(bytes, page);
    const std::size_t spare = size < huge_page ? 0 : huge_page;
    void* const mapped = ::mmap(nullptr, size + spare, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    if (spare == 0) return mapped;
    char* const begin = static_cast<char*>(mapped);
    const std::size_t before = (huge_page - reinterpret_cast<std::uintptr_t>(begin) % huge_page) % huge_page;
    if (before > 0) ::munmap(begin, before);
    if (before < spare) ::munmap(begin + before + size, spare - before);
    return begin + before;
}

/// Not the last, broken one: all of it would be there as soon as a byte of it is.
void use_huge_pages(void* memory, std::size_t bytes) {
    if (bytes >= huge_page) (void)::madvise(memory, bytes / huge_page * huge_page, MADV_HUGEPAGE);
}

#endif

void* reserve_pages(std::size_t bytes) {
#ifdef __linux__
    if (bytes >= mapped_from) return map_pages(bytes);
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
    if (bytes >= mapped_from) {
        ::munmap(memory, (bytes + page - 1) / page * page);
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
