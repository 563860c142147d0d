// Control group: limits that the system sets on the processes of a container or a service (cgroups(7), versions 1 and 2).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/private_export.hpp"

namespace octopair {

/// Limits of a control group. An empty value means that there is no limit, or that the limit cannot be read.
struct ControlGroupLimits {
    std::optional<std::uint64_t> memory_bytes;
    std::optional<double> cores;  ///< processor time for each second, in seconds
};

/// Returns the strictest limits on the control group of this process and its parents. `root`: folder that contains proc and sys.
ControlGroupLimits control_group_limits(const std::string& root = "");

/// Returns an upper bound on the bytes of memory that the control group of this process and its parents leave: the limit, less the memory
/// in use that neither belongs to files nor can be reclaimed or swapped. Returns nothing without a limit, or if it cannot be read.
/// `swap`: free swap space of the machine.
std::optional<std::uint64_t> control_group_free_memory(std::uint64_t swap, const std::string& root = "");

/// Returns the number of processors that this process may run on (sched_setaffinity(2) of its first thread); at least 1.
OCTOPAIR_PRIVATE_EXPORT unsigned allowed_processors();

/// Returns how many threads can run at a time: the processors that this process may run on, or fewer if the control group has less
/// processor time. At least 1. The limits of the control group are read once.
OCTOPAIR_PRIVATE_EXPORT unsigned available_cores();

}  // namespace octopair
