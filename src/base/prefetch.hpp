// Prefetches of cache lines, for code that includes no SIMD library.
#pragma once

namespace octopair {

/// Starts to load the cache line at `address`, for reading or writing. The address may be invalid.
inline void prefetch(const void* address) {
#if defined(__GNUC__)
    __builtin_prefetch(address);
#else
    (void)address;
#endif
}

}  // namespace octopair
