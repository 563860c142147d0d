#include "base/memory.hpp"

#include <cstdlib>
#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace octopair {

void* allocate_pages(std::size_t bytes) {
    constexpr std::size_t huge_page = std::size_t(2) << 20;
    const std::size_t alignment = bytes >= 2 * huge_page ? huge_page : 64;
    if (bytes > std::size_t(-1) - alignment) throw std::bad_alloc();
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, rounded == 0 ? alignment : rounded);
    if (memory == nullptr) throw std::bad_alloc();
#ifdef __linux__
    if (alignment == huge_page) (void)madvise(memory, rounded, MADV_HUGEPAGE);
#endif
    return memory;
}

void free_pages(void* memory) noexcept { std::free(memory); }

}  // namespace octopair
