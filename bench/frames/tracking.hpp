// One case: all trackers take turns, frame by frame, on equal boxes, and the pairs of each frame are compared.
//
// The first frame, which inserts the objects, is not counted. Comparison of pairs is not timed.
#pragma once

#include <functional>
#include <string_view>

#include "frames/cases.hpp"
#include "peers/tracker.hpp"

namespace octopair::bench {

struct FramePlan {
    unsigned frames = 100;  ///< frames after the first frame
    unsigned min_frames = 10;
    double max_seconds = 30;  ///< time limit of a tracker, after `min_frames` at least
};

/// Returns the number of frames of a case after the first.
unsigned frames_of(const FrameCase& which, const FramePlan& plan);

/// `processor`: processor time of all threads of this process. This time is more reliable for long frames when other
/// programs use the machine.
enum class Clock : std::uint8_t { wall, processor };

struct Track {
    std::string tracker;
    double first_seconds = 0;
    std::vector<double> seconds;            ///< of each frame after the first, wall clock
    std::vector<double> processor_seconds;  ///< of each frame after the first, processor time
    std::vector<double> query_seconds;      ///< by frame: mean of its queries; empty without queries
    std::uint64_t pairs = 0;                ///< of the last frame
    std::uint64_t differing = 0;            ///< frames with other pairs than the first tracker's
    std::uint64_t differs_pairs = 0;        ///< pairs found in the first differing frame
    std::uint64_t differing_queries =
        0;  ///< frames in which other numbers of objects overlap than for the first tracker that has queries

    /// Returns the time that `share` of the frames do not exceed: 0.5 for the median, 1 for the slowest.
    double quantile(double share, Clock clock = Clock::wall) const;
    double query_quantile(double share) const;
};

/// Receives the step that has just finished.
using TrackingProgress = std::function<void(std::string_view)>;

/// Runs a case. Returns tracks in the order of the case's trackers.
std::vector<Track> track(const FrameCase& which, const FramePlan& plan, const TrackingProgress& progress);

}  // namespace octopair::bench
