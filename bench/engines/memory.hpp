// Memory of an engine: application and worker processes together, beyond boxes and pairs.
//
// A separate application process measures each case. The measure is the sum of proportional set sizes of that process
// and its children. So each resident page counts once, however many processes map the page. Only the application's own
// boxes are subtracted, so a copy of the boxes counts for the engine. Pairs are subtracted with 8 bytes each; the rest
// of a list counts for the engine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::bench {

constexpr double max_engine_bytes = 80;  ///< bytes per object, sum over all processes of the process engine

struct EngineMemoryCase {
    std::string engine;  ///< name in contenders()
    std::string kind;
    std::uint64_t objects;
    Order order;
};

/// Bytes beyond boxes and pairs.
struct EngineMemoryUse {
    std::uint64_t pairs = 0;
    double idle = 0;     ///< after the start of the engine, before its first call
    double kept = 0;     ///< after the calls, by the engine and its list
    double highest = 0;  ///< highest sample during the calls

    /// Returns whether memory could be measured: not every system reports shared pages.
    bool known() const { return kept > 0; }
};

std::vector<EngineMemoryCase> engine_memory_cases();

/// Returns the memory of one case, measured in a forked process. Requires: the process has one thread. Throws:
/// std::runtime_error if the child process fails.
EngineMemoryUse measure_memory(const EngineMemoryCase& which, unsigned width);

}  // namespace octopair::bench
