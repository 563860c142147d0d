// Runs `octopair detect --events`: writes the pairs that begin and end from frame to frame.
//
// Result    The differences between the full results of consecutive frames. For each frame, the pairs that ended come first,
//           then the pairs that began, each ascending. Before the first frame there are no pairs.
// Memory    Two frames and a scene, or one frame and the pairs of two frames (EventSource).
//
// EventSource: finds the pairs that begin and end from frame to frame. There are two implementations:
//
// - scene events: a scene searches only the surroundings of the objects that moved.
// - engine events: any engine finds all pairs of each frame, which are compared with those of the frame before.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/input/frame_set.hpp"
#include "cli/input/search_inputs.hpp"
#include "octopair/engine.hpp"

namespace octopair::cli {

/// Throws: Error{usage} for options, and formats of --output, that --events excludes.
void check_event_options(const DetectRequest& request);

/// An engine that has ranks.
struct RankedEngine {
    std::unique_ptr<Engine> engine;
    unsigned ranks;
};

/// Reads the inputs, finds the events, and writes the result. The caller writes the statistics. The engine of `ranked` finds the pairs;
/// if that engine is null, the function makes the engine of the request. Throws: Error.
DetectReport detect_events(const DetectRequest& request, RankedEngine ranked, const std::stop_token& stop);

/// Sets of objects of a search. Requires: they outlive the event source.
struct FrameSets {
    const FrameSet& inputs;
    const FrameSet* against;  ///< null: pairs within the inputs
    const Paddings& paddings;
};

/// Events of a frame, ascending. In a join, `b` of a pair is the index within the second set.
struct FrameEvents {
    std::span<const Pair> ended, began;  ///< valid until the next frame
    std::uint64_t pairs = 0;             ///< number of pairs in this frame
};

class EventSource {
public:
    virtual ~EventSource() = default;
    /// Reads the boxes of a frame. Throws: what FrameSet::read() throws.
    virtual void read(std::uint64_t frame, const std::stop_token& stop) = 0;
    /// Returns the differences between the frame that was read last and the frame of the previous find(). The first find()
    /// compares with an empty result.
    virtual FrameEvents find(const std::stop_token& stop) = 0;
};

/// Makes the event source. Requires: Real is double if one of the sets is wide.
template <typename Real>
std::unique_ptr<EventSource> make_scene_events(const FrameSets& sets, const DetectRequest& request);
template <typename Real>
std::unique_ptr<EventSource> make_engine_events(const FrameSets& sets, const DetectRequest& request,
                                                std::unique_ptr<Engine> engine);

}  // namespace octopair::cli
