// Memory of a scene, measured in its own process without other scenes and engines.
//
// The measure is the resident size above the size of the caller's boxes and ids. Each frame requests the list of all
// pairs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octopair::bench {

struct MemoryCase {
    std::string kind;
    std::uint64_t objects;
    double share;     ///< share of the objects that moves in a frame
    unsigned frames;  ///< frames after the first frame
};

/// Memory in bytes, and the number of pairs.
struct MemoryUse {
    std::uint64_t pairs = 0;  ///< in the last frame
    double first_peak = 0;    ///< during insertion and the first search
    double peak = 0;          ///< in the later frames
    double steady = 0;        ///< after the last frame

    double highest() const { return first_peak > peak ? first_peak : peak; }
};

/// Promised upper bound for the memory of a scene, in bytes.
constexpr double promised_bytes(double objects, double pairs) { return 120 * objects + 16 * pairs; }

std::vector<MemoryCase> memory_cases();

/// Returns the memory of one case, measured with one thread in a forked process. Requires: the process has one thread.
/// Throws: std::runtime_error if the child process fails.
MemoryUse measure_memory(const MemoryCase& which);

}  // namespace octopair::bench
