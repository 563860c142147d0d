#include "base/control_group.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>
#include <vector>

namespace octopair {

namespace {

template <typename Number>
void lower(std::optional<Number>& limit, Number other) {
    limit = limit ? std::min(*limit, other) : other;
}

/// Returns the first number of a file, or nothing if it does not begin with a number.
std::optional<double> number_in(const std::string& path) {
    std::ifstream file(path);
    double number = 0;
    if (!(file >> number)) return {};
    return number;
}

void lower_memory(ControlGroupLimits& limits, const std::string& file) {
    constexpr double unlimited = 1e18;  // without a limit, version 1 writes a number larger than any memory
    const auto bytes = number_in(file);
    if (bytes && *bytes < unlimited) lower(limits.memory_bytes, std::uint64_t(*bytes));
}

void lower_cores(ControlGroupLimits& limits, std::optional<double> quota, std::optional<double> period) {
    if (quota && period && *quota > 0 && *period > 0) lower(limits.cores, *quota / *period);
}

/// Reads the limits of one group. `folder` is below the mount of version 2, or of a controller of version 1.
void read_group(ControlGroupLimits& limits, const std::string& folder, std::string_view controllers) {
    if (controllers.empty()) {
        lower_memory(limits, folder + "/memory.max");
        std::ifstream file(folder + "/cpu.max");
        double quota = 0, period = 0;
        if (file >> quota >> period) lower_cores(limits, quota, period);
        return;
    }
    if (controllers == "memory") lower_memory(limits, folder + "/memory.limit_in_bytes");
    if (controllers.find("cpu") != std::string_view::npos)
        lower_cores(limits, number_in(folder + "/cpu.cfs_quota_us"), number_in(folder + "/cpu.cfs_period_us"));
}

}  // namespace

ControlGroupLimits control_group_limits(const std::string& root) {
    ControlGroupLimits limits;
    std::ifstream groups(root + "/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {  // NUMBER:CONTROLLERS:PATH
        std::istringstream fields(line);
        std::string number, controllers, path;
        if (!std::getline(fields, number, ':') || !std::getline(fields, controllers, ':') ||
            !std::getline(fields, path))
            continue;
        const std::string mount = root + "/sys/fs/cgroup" + (controllers.empty() ? "" : "/" + controllers);
        for (;;) {
            read_group(limits, mount + path, controllers);
            if (path.empty()) break;
            path.resize(std::min(path.rfind('/'), path.size()));
        }
    }
    return limits;
}

unsigned allowed_processors() {
    // The kernel refuses a set with fewer processors than its own set, which may have more processors than cpu_set_t.
    constexpr std::size_t most_sets = 64;
    for (std::size_t sets = 1; sets <= most_sets; sets *= 2) {
        std::vector<cpu_set_t> processors(sets);
        const std::size_t bytes = sets * sizeof(cpu_set_t);
        if (::sched_getaffinity(::getpid(), bytes, processors.data()) == 0)
            return std::max(1u, unsigned(CPU_COUNT_S(bytes, processors.data())));
        if (errno != EINVAL) break;
    }
    return std::max(1u, std::thread::hardware_concurrency());
}

unsigned available_cores() {
    static const std::optional<double> limit = control_group_limits().cores;
    const unsigned processors = allowed_processors();
    return limit ? unsigned(std::clamp(std::ceil(*limit), 1.0, double(processors))) : processors;
}

}  // namespace octopair
