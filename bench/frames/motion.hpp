// Motion: boxes that move slightly from frame to frame.
//
// An object has a direction of its own, which it keeps: on each axis up to 10% of its size a frame, either way. Where a step
// would leave the world, the bounds of all boxes at first, the object turns back on that axis. If not all move, those that do
// are drawn afresh for each frame. The same seed gives the same frames on every machine.
#pragma once

#include <vector>

#include "peers/tracker.hpp"
#include "samples/random.hpp"

namespace octopair::bench {

class Motion {
public:
    /// `share` of the objects move in a frame, 0 to 1.
    Motion(std::vector<Box3f> boxes, double share);

    /// Before the first call of next(), the first frame.
    std::span<const Box3f> boxes() const { return boxes_; }
    /// Objects that move in a frame.
    std::size_t movers() const { return moved_.size(); }
    /// Moves on; what it returns is valid until the next call.
    Frame next();

private:
    struct Velocity {
        float along[3];
    };

    void draw_movers();
    void move(std::uint32_t object);

    std::vector<Box3f> boxes_;
    std::vector<Velocity> velocities_;
    std::vector<std::uint32_t> moved_;
    std::vector<Box3f> moved_boxes_;
    Box3f world_{};
    samples::RandomStream draws_;
};

}  // namespace octopair::bench
