// Whether a pose mirrors: then what was counterclockwise from outside is clockwise in the world.
#pragma once

#include "geometry/vector.hpp"
#include "narrow_phase/exact/orientation.hpp"

namespace octopair {

/// A pose that flattens does not.
inline bool mirrors(const Pose& pose) {
    return plane_side({0, 0, 0}, vector::column(pose, 0), vector::column(pose, 1), vector::column(pose, 2)) < 0;
}

}  // namespace octopair
