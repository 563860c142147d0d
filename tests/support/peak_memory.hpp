// Measures the peak memory of a test process.
#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace octopair::test {

/// Returns the peak resident memory of this process, in bytes.
inline std::uint64_t peak_rss() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

}  // namespace octopair::test
