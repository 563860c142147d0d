// Scales the amount of work of tests: less under sanitizers, which cost 5 to 20 times the time.
#pragma once

#include <cstdint>

namespace octopair::test {

#ifdef OCTOPAIR_TEST_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// True in builds with ThreadSanitizer. ThreadSanitizer cannot see how oneTBB orders tasks, because Debian's libtbb is
/// not instrumented.
#if defined(__SANITIZE_THREAD__)
inline constexpr bool thread_sanitized = true;
#elif defined(__has_feature)
inline constexpr bool thread_sanitized = __has_feature(thread_sanitizer);
#else
inline constexpr bool thread_sanitized = false;
#endif

/// Returns `full`, or `full / divisor` under sanitizers.
constexpr std::uint64_t scaled(std::uint64_t full, std::uint64_t divisor) {
    return sanitized ? (full + divisor - 1) / divisor : full;
}

}  // namespace octopair::test
