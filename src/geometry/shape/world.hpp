// Where a pose puts a vertex: the one place where this is computed, as all exact tests must agree on it (shapes.hpp).
#pragma once

#include "octopair/shapes.hpp"

namespace octopair {

/// Each operation is rounded once, in this order.
inline Point3d to_world(const Pose& pose, const Point3d& v) {
    Point3d world;
    for (int row = 0; row < 3; ++row) {
        const auto& r = pose.rows[row];
        world[row] = ((r[0] * v[0] + r[1] * v[1]) + r[2] * v[2]) + r[3];
    }
    return world;
}

}  // namespace octopair
