// ConvexSolid: what the convex shapes have in common, a core and all points within a radius of it.
//
// Posed     the core is where the pose, an affine map, puts it; the radius stays as it is. A sphere is a point with a
//           radius, a capsule a segment with one; other shapes are their cores.
// Support   the farthest point of a core in a direction, which need not be of length 1; of several that are as far, any.
#pragma once

#include <cstdint>
#include <vector>

#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

struct ConvexSolid {
    enum class Core : std::uint8_t { points, box, cylinder, cone, ellipsoid };

    Core core = Core::points;
    Point3d extents = {};         ///< of a box and an ellipsoid; of a cylinder and a cone: radius, radius, half length
    std::vector<Point3d> points;  ///< without any, of Core::points, there is no solid: planes and meshes have none
    double radius = 0;
    Point3d largest = {};  ///< of each axis, the largest absolute coordinate of the core

    bool exists() const { return core != Core::points || !points.empty(); }
};

/// Of a plane or a mesh: one that does not exist.
ConvexSolid make_convex_solid(const shape::Any& shape);

/// The farthest point of the core, in its own space.
Point3d support(const ConvexSolid& solid, const Point3d& direction);

}  // namespace octopair
