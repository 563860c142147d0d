// FloatingPointScope: sets the floating-point state that results are defined for: rounding to nearest, subnormal numbers kept,
// no exception traps.
//
// A caller may have another state: libraries linked with -ffast-math set one for the thread that loads them, and new threads
// inherit it.
//
// - Every public call that computes has a scope.
// - Every body that another thread runs has a scope.
// - On x86-64 only the SSE state is set: nothing in the library computes in long double.
//
// Cost: a few nanoseconds.
#pragma once

#include <atomic>

#if defined(__x86_64__) || defined(_M_X64)
#include <xmmintrin.h>
#elif defined(__aarch64__)
#include <cstdint>
#else
#include <cfenv>
#endif

namespace octopair {

/// Sets the default state for this thread. The destructor restores the previous state, flags included.
class FloatingPointScope {
public:
    FloatingPointScope() noexcept {
        set_default();
        // Keeps the compiler from moving reads of the input before this point.
        std::atomic_signal_fence(std::memory_order_seq_cst);
    }
    ~FloatingPointScope() {
        std::atomic_signal_fence(std::memory_order_seq_cst);
        restore();
    }
    FloatingPointScope(const FloatingPointScope&) = delete;
    FloatingPointScope& operator=(const FloatingPointScope&) = delete;

private:
#if defined(__x86_64__) || defined(_M_X64)
    static constexpr unsigned default_control = 0x1F80;  // all exceptions masked, all other bits 0

    void set_default() noexcept { _mm_setcsr(default_control); }
    void restore() const noexcept { _mm_setcsr(before_); }

    unsigned before_ = _mm_getcsr();
#elif defined(__aarch64__)
    static std::uint64_t control() noexcept {
        std::uint64_t value = 0;
        asm volatile("mrs %0, fpcr" : "=r"(value));
        return value;
    }
    static void set_control(std::uint64_t value) noexcept { asm volatile("msr fpcr, %0" : : "r"(value)); }
    void set_default() noexcept { set_control(0); }
    void restore() const noexcept { set_control(before_); }

    std::uint64_t before_ = control();
#else
    static std::fenv_t environment() noexcept {
        std::fenv_t value;
        (void)std::fegetenv(&value);
        return value;
    }
    void set_default() noexcept { (void)std::fesetenv(FE_DFL_ENV); }
    void restore() const noexcept { (void)std::fesetenv(&before_); }

    std::fenv_t before_ = environment();
#endif
};

}  // namespace octopair
