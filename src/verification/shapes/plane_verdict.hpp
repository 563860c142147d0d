// Verdicts on a plane and another object, by the extent of the object along the plane's normal.
#pragma once

#include "verification/shapes/convex_verdict.hpp"

namespace octopair::certificate {

/// A plane in the world: the points x with normal · x = offset. `normal` has the length 1.
struct WorldPlane {
    Vector normal;
    Real offset;

    Real height(const Vector& point) const { return dot(normal, point) - offset; }
};

/// Requires: the shape of `object` is a plane.
WorldPlane plane_in_world(const JudgedObject& object);

/// A plane and another object, which is not a plane.
struct PlanePair {
    WorldPlane plane;
    bool plane_is_first;  ///< the plane is object a of the finding
    const JudgedObject& other;
    ConvexBody body;  ///< the other object, or the convex hull of its mesh
};

/// Judges a plane and another object. Of meshes, depths and contacts are not checked.
PairVerdict judge_plane(const PlanePair& pair, const Decision& decision);

}  // namespace octopair::certificate
