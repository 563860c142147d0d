#include "support/at_allocation.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <span>
#include <string_view>
#include <thread>
#include <utility>

namespace octopair::test {

namespace {

std::atomic<bool> armed = false;
std::atomic<int> inside = 0;  // number of threads that read what follows
std::atomic<std::int64_t> allocations_left = 0;
// These change only while not armed.
std::function<void()> at_last;
std::thread::id only_thread;  // no thread: all threads count

/// Returns the address at which the library or program that contains `code` is loaded.
void* base_of(const void* code) {
    Dl_info info{};
    return ::dladdr(code, &info) == 0 ? nullptr : info.dli_fbase;
}

/// Returns whether `code` belongs to this program, to octopair's library or to the standard library.
bool counts(const void* code) {
    static void* const own = base_of(reinterpret_cast<const void*>(&base_of));
    static void* const standard = base_of(reinterpret_cast<const void*>(&std::get_terminate));
    Dl_info info{};
    if (::dladdr(code, &info) == 0) return false;
    return info.dli_fbase == own || info.dli_fbase == standard ||
           std::string_view(info.dli_fname).find("liboctopair") != std::string_view::npos;
}

/// Returns whether a function of gRPC has called this one, directly or not. An exception in a function of gRPC ends the program.
bool is_in_grpc() {
    std::array<void*, 64> frames;
    const auto depth = std::size_t(::backtrace(frames.data(), int(frames.size())));
    return std::ranges::any_of(std::span(frames).first(depth), [](const void* code) {
        Dl_info info{};
        return ::dladdr(code, &info) != 0 && std::string_view(info.dli_fname).find("libgrpc") != std::string_view::npos;
    });
}

/// Called before each allocation. `caller`: return address of the allocation. Throws: what the action throws.
void before_allocation(const void* caller) {
    if (!armed) return;
    const struct Inside {
        Inside() { ++inside; }
        ~Inside() { --inside; }
    } now;
    if (!armed || !counts(caller)) return;
    if (only_thread != std::thread::id() && only_thread != std::this_thread::get_id()) return;
    if (allocations_left == 0 && is_in_grpc()) return;
    if (allocations_left.fetch_sub(1, std::memory_order_relaxed) == 0) at_last();
}

}  // namespace

AtAllocation::AtAllocation(std::uint64_t number, std::function<void()> action, Threads threads) {
    at_last = std::move(action);
    only_thread = threads == Threads::this_one ? std::this_thread::get_id() : std::thread::id();
    allocations_left = std::int64_t(number);
    armed = true;
}

AtAllocation::~AtAllocation() {
    armed = false;
    while (inside != 0) std::this_thread::yield();
}

AtAllocation::Paused::Paused() : armed_(armed.exchange(false)) {}
AtAllocation::Paused::~Paused() { armed = armed_; }

bool AtAllocation::reached() const { return allocations_left < 0; }

namespace {

[[maybe_unused]] void* allocate(std::size_t bytes, const void* caller) {
    before_allocation(caller);
    void* const memory = std::malloc(bytes == 0 ? 1 : bytes);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

[[maybe_unused]] void* allocate(std::size_t bytes, std::align_val_t alignment, const void* caller) {
    before_allocation(caller);
    void* memory = nullptr;
    if (::posix_memalign(&memory, std::size_t(alignment), bytes == 0 ? 1 : bytes) != 0) throw std::bad_alloc();
    return memory;
}

/// Calls allocate(arguments...). Returns null if the memory does not suffice.
template <typename... Arguments>
[[maybe_unused]] void* allocate_or_null(Arguments... arguments) noexcept {
    try {
        return allocate(arguments...);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

}  // namespace

}  // namespace octopair::test

using octopair::test::before_allocation;

// Replace the functions of the standard library. The address sanitizer requires that all of them are replaced; the thread sanitizer
// forbids it.
#ifndef OCTOPAIR_TEST_THREAD_SANITIZER
using octopair::test::allocate, octopair::test::allocate_or_null;
// NOLINTBEGIN(misc-new-delete-overloads)
void* operator new(std::size_t bytes) { return allocate(bytes, __builtin_return_address(0)); }
void* operator new[](std::size_t bytes) { return allocate(bytes, __builtin_return_address(0)); }
void* operator new(std::size_t bytes, std::align_val_t to) { return allocate(bytes, to, __builtin_return_address(0)); }
void* operator new[](std::size_t bytes, std::align_val_t to) {
    return allocate(bytes, to, __builtin_return_address(0));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    return allocate_or_null(bytes, __builtin_return_address(0));
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
    return allocate_or_null(bytes, __builtin_return_address(0));
}
void* operator new(std::size_t bytes, std::align_val_t to, const std::nothrow_t&) noexcept {
    return allocate_or_null(bytes, to, __builtin_return_address(0));
}
void* operator new[](std::size_t bytes, std::align_val_t to, const std::nothrow_t&) noexcept {
    return allocate_or_null(bytes, to, __builtin_return_address(0));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
// NOLINTEND(misc-new-delete-overloads)
#endif

// The linker replaces calls of mmap and aligned_alloc by calls of these (option --wrap).
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
void* __real_mmap(void* place, std::size_t bytes, int access, int flags, int file, off_t offset);
void* __wrap_mmap(void* place, std::size_t bytes, int access, int flags, int file, off_t offset) {
    try {
        before_allocation(__builtin_return_address(0));
    } catch (const std::bad_alloc&) {
        errno = ENOMEM;
        return MAP_FAILED;
    }
    return __real_mmap(place, bytes, access, flags, file, offset);
}

void* __real_aligned_alloc(std::size_t alignment, std::size_t bytes);
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t bytes) {
    try {
        before_allocation(__builtin_return_address(0));
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
    return __real_aligned_alloc(alignment, bytes);
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
}
