// How much memory a test took.
#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace octopair::test {

/// The most memory this process ever had resident, in bytes.
inline std::uint64_t peak_rss() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

}  // namespace octopair::test
