// The engines that octopair_engines compares, by name.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::bench {

/// A scene's boxes where an engine's calls find them, and who keeps that memory: nobody where it is the caller's own.
struct PlacedBoxes {
    std::span<const Box3f> boxes;
    std::shared_ptr<const void> keeper = {};
};

struct Contender {
    std::string name;
    std::function<std::unique_ptr<Engine>(unsigned width)> make;  ///< of so many threads or workers
    std::function<PlacedBoxes(Engine&, std::span<const Box3f>)> place;
};

inline const std::string local_name = "local";
inline const std::string processes_name = "processes";
inline const std::string paper_name = "processes, as in the paper";

/// The first is believed.
std::vector<Contender> contenders();

}  // namespace octopair::bench
