// How much memory of this process lies in the machine's, as Linux tells it.
#pragma once

#include <cstdlib>
#include <fstream>
#include <string>

namespace octopair::bench {

/// A line of /proc/self/status, in bytes: VmRSS, or VmHWM for the highest since forget_peak(). 0 where there is none.
inline double status_bytes(const std::string& name) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with(name + ":")) return std::strtod(line.c_str() + name.size() + 1, nullptr) * 1024;
    }
    return 0;
}

inline void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

}  // namespace octopair::bench
