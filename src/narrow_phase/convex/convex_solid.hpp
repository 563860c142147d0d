// ConvexSolid: the common form of all convex shapes, a core and all points within a radius of it.
//
// Shapes    A sphere is a point with a radius, a capsule a segment with a radius. Other shapes are a core with radius 0.
// Pose      A pose, an affine map, transforms the core. It does not change the radius.
// Support   The farthest point of a core in a direction, which may have any length. Ties are broken arbitrarily.
#pragma once

#include <cstdint>
#include <vector>

#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

struct ConvexSolid {
    enum class Core : std::uint8_t { points, box, cylinder, cone, ellipsoid };

    Core core = Core::points;
    Point3d extents = {};         ///< box, ellipsoid: half extents; cylinder, cone: radius, radius, half length
    std::vector<Point3d> points;  ///< points of Core::points; empty for other cores, and if the solid does not exist
    double radius = 0;
    Point3d largest = {};  ///< largest absolute coordinate of the core on each axis

    /// False for planes and meshes.
    bool exists() const { return core != Core::points || !points.empty(); }
};

/// Returns the solid of a convex shape. For a plane or a mesh, returns a solid that does not exist.
ConvexSolid make_convex_solid(const shape::Any& shape);

/// Returns the farthest point of the core in `direction`, both in the shape's own coordinates.
Point3d support(const ConvexSolid& solid, const Point3d& direction);

}  // namespace octopair
