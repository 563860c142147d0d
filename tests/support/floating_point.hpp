// Floating-point states of a caller: subnormal numbers treated as 0, other rounding modes, exceptions that trap.
#pragma once

#include <gtest/gtest.h>

#include <cfenv>
#include <ostream>
#include <vector>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace octopair::test {

/// `control`: control register of the processor on x86-64, otherwise a rounding mode of <cfenv>.
struct CallerState {
    const char* name;
    unsigned control;
};

inline void PrintTo(const CallerState& state, std::ostream* out) { *out << state.name; }

#if defined(__x86_64__)

inline unsigned floating_point_control() { return _mm_getcsr(); }
inline void set_floating_point_control(unsigned control) { _mm_setcsr(control); }
inline std::vector<CallerState> caller_states() {
    constexpr unsigned masked = 0x1F80;
    return {{"no_subnormals", masked | 0x8040},
            {"downward", masked | 0x2000},
            {"upward", masked | 0x4000},
            {"toward_zero", masked | 0x6000},
            {"trapping", 0}};
}

#else

inline unsigned floating_point_control() { return unsigned(std::fegetround()); }
inline void set_floating_point_control(unsigned control) { (void)std::fesetround(int(control)); }
inline std::vector<CallerState> caller_states() {
    return {{"downward", FE_DOWNWARD}, {"upward", FE_UPWARD}, {"toward_zero", FE_TOWARDZERO}};
}

#endif

/// Calls body() in a caller's state. Fails if body() changes the state.
template <typename Body>
void call_in(const CallerState& state, Body&& body) {
    const unsigned before = floating_point_control();
    set_floating_point_control(state.control);
    try {
        body();
    } catch (...) {
        const unsigned after = floating_point_control();
        set_floating_point_control(before);
        EXPECT_EQ(after, state.control) << state.name;
        throw;
    }
    const unsigned after = floating_point_control();
    set_floating_point_control(before);
    EXPECT_EQ(after, state.control) << state.name;
}

}  // namespace octopair::test
