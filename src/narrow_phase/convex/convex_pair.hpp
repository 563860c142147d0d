// Pairs of convex things: whether they meet, how far they are apart, and where and how deep they meet.
//
// Distances of cores (convex_solid.hpp) are found by GJK in a frame at the smaller of the two. Of every distance a lower
// bound is proven by a plane between the two, so what is said to be apart is apart, whatever rounding and the search did:
// a pair within the tolerance of touching counts as one that meets.
// Tolerance the proof's rounding: about 1e-14 of the pair's size (its places are differences: not of the distance from the
//           world's origin). Between curved things the search closes in to about 1e-8 of their size.
// Symmetry  (a, b) and (b, a) are the same computation. Threads: all of this may be used by many at once.
#pragma once

#include <array>

#include "narrow_phase/convex/convex_solid.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// A solid in the world, or a triangle by its world corners; borrowed.
class PosedConvex {
public:
    PosedConvex(const ConvexSolid& solid, const Pose& pose) : solid_(&solid), pose_(&pose) {}
    explicit PosedConvex(const std::array<Point3d, 3>& triangle) : triangle_(&triangle) {}
    explicit PosedConvex(const Point3d& point) : point_(&point) {}

    const ConvexSolid* solid() const { return solid_; }                   ///< or null
    const Pose* pose() const { return pose_; }                            ///< of a solid
    const std::array<Point3d, 3>* triangle() const { return triangle_; }  ///< or null
    const Point3d* point() const { return point_; }                       ///< or null

private:
    const ConvexSolid* solid_ = nullptr;
    const Pose* pose_ = nullptr;
    const std::array<Point3d, 3>* triangle_ = nullptr;
    const Point3d* point_ = nullptr;
};

struct ConvexGap {
    double distance = 0;  ///< between the nearest points; 0 of two that meet
    double at_least = 0;  ///< what is proven: the distance is not below it
    Point3d on_a = {}, on_b = {};
};

struct ConvexContact {
    Point3d point;
    Point3d normal;  ///< of length 1, from a to b: moving b along it by `depth` parts the two
    double depth;    ///< >= 0; the least, as far as the search found
};

bool convex_meet(const PosedConvex& a, const PosedConvex& b);

/// Whether they are no further apart than this; cheaper than convex_gap.
bool convex_within(const PosedConvex& a, const PosedConvex& b, double margin);

ConvexGap convex_gap(const PosedConvex& a, const PosedConvex& b);

/// Of two that meet (of others, depth 0 at the point between them).
ConvexContact convex_contact(const PosedConvex& a, const PosedConvex& b);

/// Whether `inner` lies in `outer` and does not reach its surface (convex_contains.cpp says how that is found). Of a cylinder
/// or a cone in a hull, a layer below the surface of 1/800 of its radius does not count. A triangle and a point hold nothing.
bool convex_contains(const PosedConvex& outer, const PosedConvex& inner);

}  // namespace octopair
