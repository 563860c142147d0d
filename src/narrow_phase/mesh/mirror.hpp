// mirrors(): whether a pose mirrors. Then triangles that are counterclockwise from outside are clockwise in the world.
#pragma once

#include "geometry/vector.hpp"
#include "narrow_phase/exact/orientation.hpp"

namespace octopair {

/// Returns true if the determinant of the pose's linear part is negative. A pose that flattens does not mirror.
inline bool mirrors(const Pose& pose) {
    return plane_side({0, 0, 0}, vector::column(pose, 0), vector::column(pose, 1), vector::column(pose, 2)) < 0;
}

}  // namespace octopair
