// Verdicts on pairs of convex bodies (convex_verdict.cpp), meshes (mesh_verdict.cpp) and planes (plane_verdict.cpp), and the rules that
// they share.
#pragma once

#include <array>
#include <stop_token>
#include <string>
#include <vector>

#include "verification/shapes/distance_bounds.hpp"
#include "verification/shapes/shape_pair.hpp"

namespace octopair::certificate {

/// The decision about a pair, and what it depends on.
struct Decision {
    /// Largest errors that the narrow phase may make.
    struct Accuracy {
        Real position;  ///< error of a point, and of the distance at which objects count as meeting
        Real margin;    ///< error of the distance up to which pairs are kept
        Real length;    ///< error of a depth or a distance
        Real contact;   ///< error of a contact point of curved shapes
    };

    const StageRules& rules;
    const Finding* finding;  ///< null: the pair was dropped
    Real reach;              ///< margin and paddings
    Accuracy accuracy;

    /// Returns the class; for a pair that was dropped, `clearance`.
    CollisionClass found() const { return finding != nullptr ? finding->collision_class : CollisionClass::clearance; }
    bool says_meet() const { return found() != CollisionClass::clearance; }
    bool was_dropped() const { return finding == nullptr; }
    /// Returns whether the decision is wrong if the depth is `least` or more: it says that the objects do not meet, or it drops them.
    bool contradicts(Real least) const;
};

// Functions judge_...() that return a std::string return the fault that they found, as a text for users; empty: no fault.

/// Compares the decision with bounds on the distance of the two objects.
std::string judge_distance(const Decision& decision, Real lower, Real upper);
/// Checks that the nearest points are as far apart as the finding's distance says. Requires: the class is `clearance`.
std::string judge_nearest_points(const Decision& decision);
/// Returns a lower bound on the distance of a point from a body: their distance, or a number above `limit`.
Real least_distance(const Point3d& point, const ConvexBody& body, Real limit);
/// Returns whether all numbers of a finding are finite.
bool is_finite(const Finding& finding);

/// Judges two convex objects. `directions`: the directions along which a contained object is compared with the object around it.
PairVerdict judge_convex(const ConvexBody& a, const ConvexBody& b, const std::vector<Vector>& directions,
                         const Decision& decision);

/// Returns the directions for judge_convex(): some that are spread over the sphere, and the axes of two poses.
std::vector<Vector> compared_directions(const Pose& a, const Pose& b);

/// Returns how far `inner` extends beyond `outer` along the direction where it extends farthest; 0 or less: along no direction.
Real sticks_out(const ConvexBody& inner, const ConvexBody& outer, const std::vector<Vector>& directions);

/// Returns a number for a message, such as "0.25".
std::string text_of(Real number);

using Triangle = std::array<Vector, 3>;

/// Returns the triangles of an object in the world; none if it is not a mesh.
std::vector<Triangle> triangles_of(const JudgedObject& object);
/// Returns the triangles of an object in its own coordinates.
std::vector<Triangle> local_triangles_of(const JudgedObject& object);
/// Returns a lower bound on the distance of a point from triangles: their distance, or a number above `limit`. Complexity: linear.
Real least_distance(const Point3d& point, const std::vector<Triangle>& triangles, Real limit);

/// Judges two objects of which at least one is a mesh, and neither is a plane. Requires: a mesh has a triangle.
/// Depths and contacts are not checked. Throws: Error{cancelled}.
PairVerdict judge_meshes(const JudgedPair& pair, const Decision& decision, const std::stop_token& stop);

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
