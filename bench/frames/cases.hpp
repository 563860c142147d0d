// Cases of octopair_frames: number of objects, share that moves, trackers and goals.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octopair::bench {

enum class Statistic : std::uint8_t { median, slowest };

/// Upper bound of a ratio: a statistic of `tracker` over the median of the fastest tracker of `against`.
struct Goal {
    std::string tracker;
    Statistic statistic;
    std::vector<std::string> against;
    double most;
};

struct FrameCase {
    std::string name;
    std::uint64_t objects;  ///< boxes of the kind uniform
    double share;           ///< share of the objects that moves in a frame
    unsigned threads;
    std::vector<std::string> trackers;  ///< the first is the reference
    std::vector<Goal> goals;
    unsigned queries = 0;  ///< number of overlap queries after each frame
    unsigned frames_factor =
        1;  ///< number of frames for each frame of the plan; frames of few objects take little time
};

std::vector<FrameCase> frame_cases();

}  // namespace octopair::bench
