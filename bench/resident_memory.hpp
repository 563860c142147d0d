// Resident memory of this process, from Linux.
#pragma once

#include <cstdlib>
#include <fstream>
#include <string>

namespace octopair::bench {

/// Returns a line of /proc/self/status in bytes, or 0 if the line is missing. VmRSS: current; VmHWM: highest since
/// forget_peak().
inline double status_bytes(const std::string& name) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with(name + ":")) return std::strtod(line.c_str() + name.size() + 1, nullptr) * 1024;
    }
    return 0;
}

inline void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

}  // namespace octopair::bench
