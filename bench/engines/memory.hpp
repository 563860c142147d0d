// The memory of an engine: of the application and its worker processes together, beyond boxes and pairs.
//
// Each case is measured by an application of its own. What counts is the proportional set size of that process and of its
// children: each page that is there, once, however many of them map it. Boxes count where the application made them, so a
// copy of them is the engine's; pairs are 8 bytes each, and what a list takes beyond that is the engine's as well.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::bench {

constexpr double most_engine_bytes = 80;  ///< an object, in all processes of the process engine

struct EngineMemoryCase {
    std::string engine;  ///< by its name among contenders()
    std::string kind;
    std::uint64_t objects;
    Order order;
};

/// In bytes, beyond boxes and pairs.
struct EngineMemoryUse {
    std::uint64_t pairs = 0;
    double idle = 0;     ///< once the engine is made, before its first call
    double kept = 0;     ///< after the calls, by the engine and its list
    double highest = 0;  ///< during the calls, as often as it could be looked at

    /// Whether one can look at all: not every system shows what processes share.
    bool known() const { return kept > 0; }
};

std::vector<EngineMemoryCase> engine_memory_cases();

/// Forks, so it is to be called while the process has one thread. Throws std::runtime_error if the other process fails.
EngineMemoryUse measure_memory(const EngineMemoryCase& which, unsigned width);

}  // namespace octopair::bench
