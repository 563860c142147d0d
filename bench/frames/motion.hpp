// Motion: boxes that move slightly from frame to frame.
//
// Each object keeps a fixed step per frame: on each axis up to 10% of its size, in either direction. The world is the
// bounds of all initial boxes; an object turns back on an axis where a step would leave the world. If only a share
// moves, each frame draws new movers. Equal seeds give equal frames on every machine.
#pragma once

#include <vector>

#include "peers/tracker.hpp"
#include "samples/random.hpp"

namespace octopair::bench {

class Motion {
public:
    /// `share`: part of the objects that moves in a frame, 0 to 1.
    Motion(std::vector<Box3f> boxes, double share);

    /// Returns the boxes of the last next(); before the first call of next(), the boxes of the first frame.
    std::span<const Box3f> boxes() const { return boxes_; }
    /// Returns the number of objects that move in a frame.
    std::size_t movers() const { return moved_.size(); }
    /// Advances by a frame. The result is valid until the next call.
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
