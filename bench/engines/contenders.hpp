// Engines that octopair_engines compares, by name.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::bench {

/// Boxes of a scene in the memory that calls read. `keeper` owns this memory; null if the caller owns the memory.
struct PlacedBoxes {
    std::span<const Box3f> boxes;
    std::shared_ptr<const void> keeper = {};
};

struct Contender {
    std::string name;
    std::function<std::unique_ptr<Engine>(unsigned width)> make;  ///< with `width` threads or workers
    std::function<PlacedBoxes(Engine&, std::span<const Box3f>)> place;
};

inline const std::string local_name = "local";
inline const std::string processes_name = "processes";

/// Returns all contenders. The pairs of the first contender are the reference.
std::vector<Contender> contenders();

}  // namespace octopair::bench
