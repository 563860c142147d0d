// Segments against segments and triangles, all closed and possibly degenerate: what the tests of triangles fall back on.
// Slow: made for the few that are coplanar or degenerate.
#pragma once

#include <array>

#include "octopair/pose.hpp"

namespace octopair {

/// Both ends may be one place.
using Segment3d = std::array<Point3d, 2>;

/// Along which axis a triangle is seen with an area; 3 if it is degenerate. `side`: whether it is counterclockwise then.
struct Facing {
    unsigned axis = 3;
    int side = 0;
};
Facing facing(const Triangle3d& triangle);

/// The two corners that are furthest apart, if it is degenerate.
Segment3d hull_of_degenerate(const Triangle3d& triangle);

/// An axis along which a plane that holds both is seen one to one; 3 if all lie on a line. Of segments in one plane.
unsigned facing_axis(const Segment3d& s, const Segment3d& t);

bool segments_meet(const Segment3d& s, const Segment3d& t);
bool segment_meets_triangle(const Segment3d& segment, const Triangle3d& triangle);

}  // namespace octopair
