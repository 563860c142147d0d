// Cases of octopair_frames: number of objects, share that moves, and trackers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octopair::bench {

struct FrameCase {
    std::string name;
    std::uint64_t objects;  ///< boxes of the kind uniform
    double share;           ///< share of the objects that moves in a frame
    unsigned threads;
    std::vector<std::string> trackers;  ///< the first is the reference
    unsigned queries = 0;               ///< number of overlap queries after each frame
    unsigned frames_factor =
        1;  ///< number of frames for each frame of the plan; frames of few objects take little time
};

std::vector<FrameCase> frame_cases();

}  // namespace octopair::bench
