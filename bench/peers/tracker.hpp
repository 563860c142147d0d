// Tracker: one way to know all pairs of a set of boxes that move from frame to frame, as octopair_frames runs it.
//
// A tracker keeps what it has built between frames and is told what moved, as its users would tell it. After each frame the
// whole list of pairs lies in memory, unless its name says otherwise. Each must find the same pairs as a full detection of
// the frame's boxes.
#pragma once

#include "peers/contender.hpp"

namespace octopair::bench {

/// Boxes of one moment; borrowed, at the same place in every frame of a motion.
struct Frame {
    std::span<const Box3f> boxes;          ///< of all objects
    std::span<const std::uint32_t> moved;  ///< the objects that have moved since the frame before, ascending
    std::span<const Box3f> moved_boxes;    ///< the new boxes of these, in this order

    bool all_moved() const { return moved.size() == boxes.size(); }
};

class Tracker {
public:
    Tracker() = default;
    Tracker(const Tracker&) = delete;
    Tracker& operator=(const Tracker&) = delete;
    virtual ~Tracker() = default;

    /// The first frame: takes all objects in, and finds their pairs. Called once.
    virtual void begin(std::span<const Box3f> boxes) = 0;
    /// A further frame: what is timed.
    virtual void next(const Frame& frame) = 0;
    /// What the last frame found; a hash of 0 from one that only counts.
    virtual Found found() const = 0;
};

/// Collects pairs in one list.
class CollectingTracker : public Tracker {
public:
    Found found() const override;

protected:
    std::vector<Pair> pairs_;
};

struct TrackerKind {
    std::string name;
    bool threads;  ///< can use more than one
    std::unique_ptr<Tracker> (*make)(unsigned threads);
};

/// Ours first, then every peer that this build has.
std::vector<TrackerKind> tracker_kinds();

// A file each, that of the contenders.
std::vector<TrackerKind> octopair_trackers();
std::vector<TrackerKind> bullet_trackers();
std::vector<TrackerKind> fcl_trackers();
std::vector<TrackerKind> ode_trackers();

}  // namespace octopair::bench
