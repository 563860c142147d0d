// Decides which boxes and paddings are valid: the rule for NaN, infinity and inverted boxes.
// Start here to change what NaN and infinity do.
#pragma once

#include <cfloat>
#include <cmath>
#include <limits>

#include "octopair/objects.hpp"

namespace octopair {

/// True if min <= max on each axis and all numbers are finite.
template <typename Real>
bool is_box(const Box<Real>& box) {
    bool good = true;
    for (int axis = 0; axis < 3; ++axis) {
        // Also false for NaN. |value| <= max is false for infinities.
        good &= box.min[axis] <= box.max[axis];
        good &= std::abs(box.min[axis]) <= std::numeric_limits<Real>::max();
        good &= std::abs(box.max[axis]) <= std::numeric_limits<Real>::max();
    }
    return good;
}

/// True if the padding of an object is a finite number >= 0.
inline bool is_padding(double value) { return value >= 0 && value <= DBL_MAX; }

}  // namespace octopair
