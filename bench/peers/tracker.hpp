// Tracker: one way to maintain all pairs of a set of moving boxes from frame to frame, for octopair_frames.
//
// A tracker keeps its data structures between frames and receives the moved objects of each frame. After each frame the
// whole list of pairs is in memory, unless the tracker's name says otherwise. Each tracker must find the pairs that
// full detection finds.
#pragma once

#include <optional>

#include "peers/contender.hpp"

namespace octopair::bench {

/// Boxes of one frame. Borrowed; the memory stays in place for all frames of a motion.
struct Frame {
    std::span<const Box3f> boxes;          ///< of all objects
    std::span<const std::uint32_t> moved;  ///< objects that moved since the frame before, ascending
    std::span<const Box3f> moved_boxes;    ///< new boxes of `moved`, in the order of `moved`

    bool all_moved() const { return moved.size() == boxes.size(); }
};

class Tracker {
public:
    Tracker() = default;
    Tracker(const Tracker&) = delete;
    Tracker& operator=(const Tracker&) = delete;
    virtual ~Tracker() = default;

    /// Inserts all objects of the first frame and finds their pairs. Called once.
    virtual void begin(std::span<const Box3f> boxes) = 0;
    /// Processes a further frame. This call is timed.
    virtual void next(const Frame& frame) = 0;
    /// Returns the number and the hash of the last frame's pairs; hash 0 from a tracker that only counts.
    virtual Found found() const = 0;
    /// Returns the number of objects that overlap a box, summed over all boxes; nothing if the tracker has no such query. This call is
    /// timed.
    virtual std::optional<std::uint64_t> overlaps(std::span<const Box3f> boxes) {
        (void)boxes;
        return std::nullopt;
    }
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
    bool threads;  ///< true: can use several threads
    std::unique_ptr<Tracker> (*make)(unsigned threads);
};

/// Returns octopair's trackers, then every peer in this build.
std::vector<TrackerKind> tracker_kinds();

// Trackers of each library, in the source file of its contenders.
std::vector<TrackerKind> octopair_trackers();
std::vector<TrackerKind> bullet_trackers();
std::vector<TrackerKind> fcl_trackers();
std::vector<TrackerKind> ode_trackers();

}  // namespace octopair::bench
