// What begins and ends from frame to frame, found in one of two ways: by a scene, which looks around what moved, or by
// any engine, which finds all pairs of each frame, and a comparison with those of the frame before.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>

#include "cli/detect/detection.hpp"
#include "cli/input/frame_set.hpp"
#include "cli/input/join.hpp"

namespace octopair::cli {

/// The sets of objects; all outlive what is made of them.
struct FrameSets {
    const FrameSet& inputs;
    const FrameSet* against;  ///< null: pairs within the inputs
    const Paddings& paddings;
};

/// Ascending; in a join, b is numbered within its own set.
struct FrameEvents {
    std::span<const Pair> ended, began;  ///< valid until the next frame
    std::uint64_t pairs = 0;             ///< that there are now
};

class EventSource {
public:
    virtual ~EventSource() = default;
    /// Throws Error as FrameSet::read does.
    virtual void read(std::uint64_t frame, const std::stop_token& stop) = 0;
    /// Of the frame that was read, against the one that was found before; the first one, against no pairs.
    virtual FrameEvents find(const std::stop_token& stop) = 0;
};

/// Real is double where one of the sets is wide.
template <typename Real>
std::unique_ptr<EventSource> make_scene_events(const FrameSets& sets, const DetectRequest& request);
template <typename Real>
std::unique_ptr<EventSource> make_engine_events(const FrameSets& sets, const DetectRequest& request);

}  // namespace octopair::cli
