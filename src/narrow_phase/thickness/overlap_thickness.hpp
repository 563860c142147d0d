// Thickness of the overlap of two closed meshes, or of a closed mesh and a convex solid: the diameter of the largest ball that lies in both solids.
//
// Search    Boxes that divide the common box, the largest first. Each asks whether a ball with its centre in the box, and of a diameter
//           above the tolerance, may lie in both solids:
//   no      The surface of the overlap around the box lies in planks whose widths sum to at most the tolerance, and no region outside
//           of the planks lies in both solids. By Bang's theorem (plank.hpp) they do not cover such a ball.
//   yes     A point of the box is further than half the tolerance inside both solids.
//   else    The box is divided, down to an eighth of the tolerance.
// Opens     Planks count only if they open (plank_cover.hpp). So a thin overlap that goes through a solid stays undecided or thick.
// Rounding  Decisions are right up to rounding: about 1e-13 of the coordinates.
#pragma once

#include <cstdint>
#include <stop_token>

#include "narrow_phase/mesh/mesh_convex.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "octopair/collision.hpp"

namespace octopair {

struct OverlapThickness {
    ThicknessKind kind = ThicknessKind::unknown;
    double thickness = 0;
};

/// Compares the thickness with a tolerance > 0. Returns a thickness of at most the tolerance (`at_most`) only if the overlap opens
/// everywhere. Otherwise returns the diameter of a ball that was found (`at_least`), or says that the search decided nothing (`undecided`).
/// After a stop request the result is unspecified. Requires: both meshes are closed and have triangles.
OverlapThickness overlap_thickness(const PosedMesh& a, const PosedMesh& b, double tolerance,
                                   const std::stop_token& stop);

/// Compares the thickness of the overlap of a closed mesh and a convex solid with a tolerance, by a mesh around the solid. Returns `unknown` for a convex hull of points.
OverlapThickness overlap_thickness(const PosedMesh& mesh, const BoxedSolid& solid, double tolerance,
                                   const std::stop_token& stop);

}  // namespace octopair
