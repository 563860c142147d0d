// Measurements of memory: in a process of their own, without memory left by other cases, and from Linux.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace octopair::bench {

/// Returns the result of `measure`, which runs in a child process and is copied through a pipe as bytes. Forks.
/// Requires: the process has one thread. Throws: std::runtime_error if the child process fails.
template <typename Measure>
auto measured_apart(const Measure& measure) {
    using Use = decltype(measure());
    static_assert(std::is_trivially_copyable_v<Use>);
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("cannot create a pipe");
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error("cannot start a process");
    if (child == 0) {
        Use use;
        try {
            use = measure();
        } catch (...) {
            ::_exit(1);
        }
        ::_exit(::write(ends[1], &use, sizeof use) == ssize_t(sizeof use) ? 0 : 1);
    }
    ::close(ends[1]);
    Use use;
    const bool told = ::read(ends[0], &use, sizeof use) == ssize_t(sizeof use);
    ::close(ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    if (!told || status != 0) throw std::runtime_error("the process that measures memory failed");
    return use;
}

// Resident memory of this process.

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
