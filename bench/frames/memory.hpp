// The memory of a scene, in a process of its own, which knows nothing of other scenes and engines.
//
// What counts is the resident size above that of the caller's boxes and ids. All pairs are asked for in each frame.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octopair::bench {

struct MemoryCase {
    std::string kind;
    std::uint64_t objects;
    double share;     ///< of the objects move in a frame
    unsigned frames;  ///< after the first
};

/// In bytes.
struct MemoryUse {
    std::uint64_t pairs = 0;  ///< in the last frame
    double first_peak = 0;    ///< while the objects are taken in and their pairs are found
    double peak = 0;          ///< in the frames after that
    double steady = 0;        ///< after the last

    double highest() const { return first_peak > peak ? first_peak : peak; }
};

/// What a scene may take at most.
constexpr double promised_bytes(double objects, double pairs) { return 120 * objects + 16 * pairs; }

std::vector<MemoryCase> memory_cases();

/// Forks, so it is to be called while the process has one thread. One thread is used. Throws std::runtime_error if the
/// other process fails.
MemoryUse measure_memory(const MemoryCase& which);

}  // namespace octopair::bench
