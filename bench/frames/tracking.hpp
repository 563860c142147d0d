// One case: all trackers take turns, frame by frame, on the same boxes; each frame's pairs are compared.
//
// The first frame, in which a tracker takes the objects in, is not counted. What is compared is not timed.
#pragma once

#include <functional>
#include <string_view>

#include "frames/cases.hpp"
#include "peers/tracker.hpp"

namespace octopair::bench {

struct FramePlan {
    unsigned frames = 100;  ///< after the first
    unsigned least_frames = 10;
    double most_seconds = 30;  ///< after which a peer ends, but not before `least_frames`
};

/// `processor`: of all threads of this process. Where others use the machine as well it says more of a frame that takes
/// longer than a turn on the processor.
enum class Clock : std::uint8_t { wall, processor };

struct Track {
    std::string tracker;
    double first_seconds = 0;
    std::vector<double> seconds;            ///< of each frame after the first, wall clock
    std::vector<double> processor_seconds;  ///< likewise
    std::uint64_t pairs = 0;                ///< of its last frame
    std::uint64_t differing = 0;            ///< frames in which it found other pairs than the first tracker
    std::uint64_t differs_pairs = 0;        ///< what it found in the first of these

    /// The time that `share` of the frames do not exceed: 0.5 for the median, 1 for the slowest.
    double quantile(double share, Clock clock = Clock::wall) const;
};

/// How far a goal is reached: the ratio that it bounds. Throws std::out_of_range for a tracker that is not there.
double reached(const Goal& goal, const std::vector<Track>& tracks, Clock clock = Clock::wall);

/// Is told what has just been done.
using TrackingProgress = std::function<void(std::string_view)>;

/// In the order of the case's trackers.
std::vector<Track> track(const FrameCase& which, const FramePlan& plan, const TrackingProgress& progress);

}  // namespace octopair::bench
