// Convex shapes judged by what points are in them, and nothing else: an oracle that knows no support functions.
#pragma once

#include "geometry/vector.hpp"
#include "octopair/shapes.hpp"

namespace octopair::test {

/// The shape's point that is nearest to another one.
Point3d nearest_in(const shape::Any& shape, const Point3d& to);

struct PosedShape {
    shape::Any shape;
    Pose pose;  // turned and moved only
};
Point3d nearest_in(const PosedShape& posed, const Point3d& to);

/// At least the distance of two shapes, by going from each to the other's nearest point so many times; it comes close to
/// the distance.
double distance_by_turns(const PosedShape& a, const PosedShape& b, int times);

}  // namespace octopair::test
