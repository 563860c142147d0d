// How much the tests do: less under sanitizers, which cost 5 to 20 times the time.
#pragma once

#include <cstdint>

namespace octopair::testing {

#ifdef OCTOPAIR_TEST_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// `full`, or a `divisor`th of it under sanitizers.
constexpr std::uint64_t scaled(std::uint64_t full, std::uint64_t divisor) {
    return sanitized ? (full + divisor - 1) / divisor : full;
}

}  // namespace octopair::testing
