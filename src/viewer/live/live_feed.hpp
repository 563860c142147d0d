// LiveFeed: the latest frame of a running scene, and the differences between frames that pages get (kind "live" of
// viewer/protocol.md).
//
// Invariants
//   Rows are the first `most_shown` indices of the scene, in order.
//   changed_[row] is the last frame in which the row's box differed from the frame before.
//   pairs_ has the pairs of the latest frame: a state with all pairs replaces pairs_, and a state with events changes pairs_.
//
// Thread safety: all functions may be called by any thread.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "octopair/scene.hpp"
#include "viewer/scene/shown_objects.hpp"
#include "viewer/scene/source.hpp"

namespace octopair::viewer {

/// State of a running scene after a step.
struct LiveState {
    std::variant<std::vector<Box3f>, std::vector<Box3d>> boxes;  ///< by index
    std::vector<std::uint8_t> exists;                            ///< by index; empty: all exist
    /// All pairs, or the first ones, ascending. If absent, the pairs are those of the last state, changed by the events.
    std::optional<std::vector<Pair>> pairs;
    /// A pair that began or ended.
    struct PairEvent {
        Pair pair;
        bool began;
    };
    std::vector<PairEvent> events;  ///< since the last state, in order of time
    std::uint64_t pair_count = 0;   ///< number of all pairs, also of those that are not in `pairs`
    std::uint64_t step = 0;         ///< number of steps so far
    double step_seconds = 0;
};

class LiveFeed {
public:
    static constexpr std::size_t default_most_shown = 200'000;

    explicit LiveFeed(std::size_t most_shown = default_most_shown) : most_shown_(most_shown) {}

    /// Makes the next frame, from the next state of the scene.
    void put(LiveState&& state);
    /// Returns the frame for a page that has frame `last` (-1: none); null if there is none newer.
    Message frame_after(std::int64_t last);

    /// A frame, and the pairs that began and ended in it.
    struct Frame {
        FrameData data;
        std::vector<Pair> began, ended;
    };
    /// Returns the latest frame. Before the first put(), returns a frame without objects.
    Frame latest() const;
    /// Returns the origin of all frames: the centre of the first frame with objects.
    Point3d origin() const;
    std::size_t most_shown() const { return most_shown_; }

private:
    /// Pairs that began and ended in a frame.
    struct Difference {
        std::uint32_t frame;
        std::vector<Pair> began, ended;
    };
    struct Head;

    std::size_t shown() const;
    void update_rows(bool whole);
    Difference update_pairs(LiveState& next);
    std::string whole_frame() const;
    std::string difference_since(std::uint32_t last) const;
    Head head() const;

    static constexpr std::size_t max_messages = 16;
    // Limits on differences_. A page whose frame is older than all kept differences gets a whole frame.
    static constexpr std::size_t max_differences = 256, max_events = 1'000'000;

    const std::size_t most_shown_;
    mutable std::mutex mutex_;
    std::int64_t frame_ = -1;
    std::int64_t oldest_base_ = 0;  // a page with an older frame than this number gets a whole frame
    std::shared_ptr<const LiveState> state_ = std::make_shared<LiveState>();
    std::vector<Pair> pairs_;
    std::vector<Pair> began_, ended_;  // of the latest frame
    Point3d origin_ = {};
    bool has_origin_ = false;  // true after a frame with objects
    bool incomplete_ = false;  // true while put() runs, and after it has failed
    std::vector<RelativeBox> rows_;
    std::vector<std::uint32_t> changed_;  // by row
    std::deque<Difference> differences_;
    std::size_t kept_events_ = 0;           // pairs in differences_
    std::map<std::int64_t, Message> made_;  // messages of the latest frame, by the frame that the page has
};

}  // namespace octopair::viewer
