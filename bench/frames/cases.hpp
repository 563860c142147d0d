// The cases of octopair_frames: how many objects, how many of them move, who keeps track, and what is aimed at.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octopair::bench {

enum class Statistic : std::uint8_t { median, slowest };

/// A statistic of one tracker over the median of another, the fastest of several.
struct Goal {
    std::string tracker;
    Statistic statistic;
    std::vector<std::string> against;
    double most;
};

struct FrameCase {
    std::string name;
    std::uint64_t objects;  ///< of the kind uniform
    double share;           ///< of them move in a frame
    unsigned threads;
    std::vector<std::string> trackers;  ///< the first is believed
    std::vector<Goal> goals;
};

std::vector<FrameCase> frame_cases();

}  // namespace octopair::bench
