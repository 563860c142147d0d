// What is done to every box on its way in.
#pragma once

#include <cmath>
#include <limits>
#include <span>

#include "geometry/entry.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// min <= max on every axis, and all finite.
template <typename Real>
bool is_box(const Box<Real>& box) {
    bool good = true;
    for (int axis = 0; axis < 3; ++axis) {
        // Also false for NaN; |finite| <= max is false for the infinities.
        good &= box.min[axis] <= box.max[axis];
        good &= std::abs(box.min[axis]) <= std::numeric_limits<Real>::max();
        good &= std::abs(box.max[axis]) <= std::numeric_limits<Real>::max();
    }
    return good;
}

/// Copies the bounds of boxes as they are; false if is_box() is not true of all.
bool copy_boxes(std::span<const Box3f> boxes, std::span<Entry> out);

}  // namespace octopair
