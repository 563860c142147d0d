// Pairs of convex objects: whether they meet, their distance, and the point and depth of their contact.
//
// Method    GJK finds the distance of the cores (convex_solid.hpp), in local coordinates near the pair (local_convex.hpp).
// Safety    A plane between the two objects proves a lower bound on each distance. Objects that are reported apart are
//           apart, whatever the rounding and the search did. A pair within the tolerance counts as a pair that meets.
// Tolerance The rounding of the proof: about 1e-14 of the pair's size, not of the distance from the world's origin.
//           Between curved objects the search converges to about 1e-8 of their size.
// Symmetry  (a, b) and (b, a) are the same computation.
// Threads   All functions may be called by many threads at once.
#pragma once

#include <array>

#include "narrow_phase/convex/convex_solid.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// A posed solid, or a triangle or a point in world coordinates. Borrowed.
class PosedConvex {
public:
    PosedConvex(const ConvexSolid& solid, const Pose& pose) : solid_(&solid), pose_(&pose) {}
    explicit PosedConvex(const std::array<Point3d, 3>& triangle) : triangle_(&triangle) {}
    explicit PosedConvex(const Point3d& point) : point_(&point) {}

    const ConvexSolid* solid() const { return solid_; }                   ///< null for a triangle or a point
    const Pose* pose() const { return pose_; }                            ///< null unless solid() is set
    const std::array<Point3d, 3>* triangle() const { return triangle_; }  ///< null for a solid or a point
    const Point3d* point() const { return point_; }                       ///< null for a solid or a triangle

private:
    const ConvexSolid* solid_ = nullptr;
    const Pose* pose_ = nullptr;
    const std::array<Point3d, 3>* triangle_ = nullptr;
    const Point3d* point_ = nullptr;
};

struct ConvexGap {
    double distance = 0;           ///< distance of the nearest points; 0 if the objects meet
    double at_least = 0;           ///< proven lower bound on the distance
    Point3d on_a = {}, on_b = {};  ///< nearest points
};

struct ConvexContact {
    Point3d point;
    Point3d normal;  ///< length 1, from a to b: moving b along `normal` by `depth` separates the two
    double depth;    ///< penetration depth, >= 0: the smallest that the search found
};

bool convex_meet(const PosedConvex& a, const PosedConvex& b);

/// Returns true if the distance is at most `margin`. Cheaper than convex_gap().
bool convex_within(const PosedConvex& a, const PosedConvex& b, double margin);

ConvexGap convex_gap(const PosedConvex& a, const PosedConvex& b);

/// Returns the contact of two objects that meet. If they do not meet, the depth is 0 and the point lies between them.
ConvexContact convex_contact(const PosedConvex& a, const PosedConvex& b);

/// Returns a proven lower bound on the depth of two objects; 0 if they may be apart.
double convex_depth_at_least(const PosedConvex& a, const PosedConvex& b);

/// Returns true if `inner` lies inside `outer` and does not reach its surface; convex_contains.cpp describes the method.
/// Always false if `outer` is a triangle or a point.
bool convex_contains(const PosedConvex& outer, const PosedConvex& inner);

}  // namespace octopair
