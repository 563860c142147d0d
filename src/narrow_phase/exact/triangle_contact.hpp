// Contacts of two triangles: how they meet, the points that they have in common, and the penetration depth.
//
// Exact signs decide how the triangles meet. Points and depths are computed in float64.
#pragma once

#include <array>
#include <cstdint>

#include "octopair/collision.hpp"
#include "octopair/pose.hpp"

namespace octopair {

enum class TriangleMeeting : std::uint8_t {
    none,
    touching,     ///< the triangles meet, but neither overlap nor cross
    overlapping,  ///< coplanar, with a common area
    crossing      ///< in different planes; the interiors pass through each other
};

struct TriangleContact {
    TriangleMeeting meeting = TriangleMeeting::none;
    unsigned count = 0;  ///< number of points: 0: none; 1: a point; 2: a segment; more: a polygon, in order
    std::array<Point3d, 6> points = {};  ///< corners of the set that the triangles have in common
};

TriangleContact triangle_contact(const Triangle3d& a, const Triangle3d& b);

/// Shortest translation that separates two triangles: b moved along `normal` by `depth` at most touches a.
struct TriangleDepth {
    Point3d normal = {0, 0, 1};  ///< length 1; arbitrary if both triangles are points
    double depth = 0;
};
/// Requires: the triangles meet.
TriangleDepth triangle_depth(const Triangle3d& a, const Triangle3d& b);

/// Returns the contact: the mean of the common points, with the shortest translation that separates the triangles. The
/// features are left unset. Requires: the triangles meet; `common` is triangle_contact(a, b).
Contact contact_of(const Triangle3d& a, const Triangle3d& b, const TriangleContact& common);

}  // namespace octopair
