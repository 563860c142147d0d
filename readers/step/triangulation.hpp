// Triangulation of solids and shells, with a bound on its error.
#pragma once

#include <TopoDS_Shape.hxx>

namespace octopair::reader {

/// Triangulates the faces of a shape, so that the triangles are about `chord` (mm) away from the surface. Open CASCADE takes this for an aim,
/// which it misses on spheres and free surfaces by up to three times. So returns how far the triangles may be away: the distance measured at
/// the middles of triangles and of their edges, at least `chord`; and the largest tolerance of edges and vertices, by which faces may not
/// meet.
double triangulate(const TopoDS_Shape& shape, double chord);

}  // namespace octopair::reader
