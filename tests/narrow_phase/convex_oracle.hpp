// Oracle for convex shapes. Computes nearest points of single shapes, without support functions.
#pragma once

#include "geometry/vector.hpp"
#include "octopair/shapes.hpp"

namespace octopair::test {

/// Returns the shape's point that is nearest to `to`.
Point3d nearest_in(const shape::Any& shape, const Point3d& to);

struct PosedShape {
    shape::Any shape;
    Pose pose;  // rotation and translation only
};
Point3d nearest_in(const PosedShape& posed, const Point3d& to);

/// Returns an upper bound of the distance of two shapes, close to the distance. Moves alternately to the nearest point
/// of each shape, for a given number of turns.
double distance_by_turns(const PosedShape& a, const PosedShape& b, int times);

}  // namespace octopair::test
