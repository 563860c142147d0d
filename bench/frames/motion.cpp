#include "frames/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace octopair::bench {

namespace {

constexpr std::uint64_t seed = 2;
constexpr double max_move = 0.1;  // largest step per frame on an axis, as a fraction of the object's size

Box3f bounds_of(std::span<const Box3f> boxes) {
    Box3f all = boxes.front();
    for (const Box3f& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) {
            all.min[axis] = std::min(all.min[axis], box.min[axis]);
            all.max[axis] = std::max(all.max[axis], box.max[axis]);
        }
    }
    return all;
}

}  // namespace

Motion::Motion(std::vector<Box3f> boxes, double share)
    : boxes_(std::move(boxes)),
      velocities_(boxes_.size()),
      moved_(std::size_t(std::llround(share * double(boxes_.size())))),
      moved_boxes_(moved_.size()),
      world_(bounds_of(boxes_)),
      draws_(seed, boxes_.size()) {
    std::iota(moved_.begin(), moved_.end(), 0u);
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
        samples::RandomStream random(seed, i);
        for (int axis = 0; axis < 3; ++axis) {
            const double size = double(boxes_[i].max[axis]) - double(boxes_[i].min[axis]);
            velocities_[i].along[axis] = float(size * random.uniform(-max_move, max_move));
        }
    }
}

/// Draws the moving objects by Knuth's selection sampling: each set of that size is equally likely, and the result
/// ascends.
void Motion::draw_movers() {
    std::size_t drawn = 0;
    for (std::uint32_t i = 0; drawn < moved_.size(); ++i) {
        if (draws_.below(boxes_.size() - i) < moved_.size() - drawn) moved_[drawn++] = i;
    }
}

void Motion::move(std::uint32_t object) {
    Box3f& box = boxes_[object];
    for (int axis = 0; axis < 3; ++axis) {
        float& by = velocities_[object].along[axis];
        if (box.min[axis] + by < world_.min[axis] || box.max[axis] + by > world_.max[axis]) by = -by;
        box.min[axis] += by;
        box.max[axis] += by;
    }
}

Frame Motion::next() {
    if (moved_.size() < boxes_.size()) draw_movers();
    for (std::size_t i = 0; i < moved_.size(); ++i) {
        move(moved_[i]);
        moved_boxes_[i] = boxes_[moved_[i]];
    }
    return {boxes_, moved_, moved_boxes_};
}

}  // namespace octopair::bench
