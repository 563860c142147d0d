// OuterMesh: a closed mesh around a convex solid, to compare the thickness of overlaps with curved solids.
#pragma once

#include <optional>

#include "narrow_phase/convex/convex_solid.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

struct OuterMesh {
    shape::Mesh mesh;  ///< contains the solid, in the solid's own coordinates
    double error = 0;  ///< no point of the mesh is further from the solid
};

/// Returns a mesh whose error is about `error`; more if the solid is so large that the mesh would have too many triangles. Returns nothing for the
/// convex hull of points.
std::optional<OuterMesh> make_outer_mesh(const ConvexSolid& solid, double error);

}  // namespace octopair
