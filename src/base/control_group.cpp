#include "base/control_group.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
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

constexpr double unlimited = 1e18;  // without a limit, version 1 writes a number larger than any memory

void lower_memory(ControlGroupLimits& limits, const std::string& file) {
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

/// Calls visit(folder, controllers) for each control group of this process and for the parents of the groups. `folder` is below the mount of
/// version 2, where `controllers` is empty, or of a controller of version 1.
template <typename Visit>
void for_each_group(const std::string& root, const Visit& visit) {
    std::ifstream groups(root + "/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {  // NUMBER:CONTROLLERS:PATH
        std::istringstream fields(line);
        std::string number, controllers, path;
        if (!std::getline(fields, number, ':') || !std::getline(fields, controllers, ':') ||
            !std::getline(fields, path))
            continue;
        const std::string mount = root + "/sys/fs/cgroup" + (controllers.empty() ? "" : "/" + controllers);
        for (;;) {
            visit(mount + path, std::string_view(controllers));
            if (path.empty()) break;
            path.resize(std::min(path.rfind('/'), path.size()));
        }
    }
}

/// Names of the files of a group that show its memory. `swap_with_memory`: the swap files count memory and swap together.
struct MemoryFiles {
    const char *limit, *used, *swap_limit, *swap_used;
    bool swap_with_memory;
    std::array<std::string_view, 3> reclaimable;  // names in memory.stat
};
constexpr MemoryFiles files_of_version_2 = {"/memory.max",
                                            "/memory.current",
                                            "/memory.swap.max",
                                            "/memory.swap.current",
                                            false,
                                            {"inactive_file", "active_file", "slab_reclaimable"}};
constexpr MemoryFiles files_of_version_1 = {"/memory.limit_in_bytes",
                                            "/memory.usage_in_bytes",
                                            "/memory.memsw.limit_in_bytes",
                                            "/memory.memsw.usage_in_bytes",
                                            true,
                                            {"total_inactive_file", "total_active_file"}};

/// Returns the sum of the numbers in memory.stat that can be reclaimed.
double reclaimable_in(const std::string& folder, const MemoryFiles& files) {
    std::ifstream file(folder + "/memory.stat");
    double sum = 0, number = 0;
    for (std::string name; file >> name >> number;) {
        if (std::ranges::find(files.reclaimable, name) != files.reclaimable.end()) sum += number;
    }
    return sum;
}

/// Lowers `free` to what a group leaves.
void lower_free(std::optional<std::uint64_t>& free, const std::string& folder, const MemoryFiles& files, double swap) {
    const auto limit = number_in(folder + files.limit), used = number_in(folder + files.used);
    if (!limit || !used || *limit >= unlimited) return;
    const auto swap_limit = number_in(folder + files.swap_limit), swap_used = number_in(folder + files.swap_used);
    const double reclaimable = reclaimable_in(folder, files);
    const double memory = *limit - *used + reclaimable;
    double all = memory + swap;
    if (swap_limit && swap_used) {
        const double left = *swap_limit - *swap_used;
        all = std::min(all, left + (files.swap_with_memory ? reclaimable : memory));
    }
    lower(free, std::uint64_t(std::max(0.0, all)));
}

}  // namespace

ControlGroupLimits control_group_limits(const std::string& root) {
    ControlGroupLimits limits;
    for_each_group(root, [&](const std::string& folder, std::string_view controllers) {
        read_group(limits, folder, controllers);
    });
    return limits;
}

std::optional<std::uint64_t> control_group_free_memory(std::uint64_t swap, const std::string& root) {
    std::optional<std::uint64_t> free;
    for_each_group(root, [&](const std::string& folder, std::string_view controllers) {
        if (controllers.empty()) lower_free(free, folder, files_of_version_2, double(swap));
        if (controllers == "memory") lower_free(free, folder, files_of_version_1, double(swap));
    });
    return free;
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
