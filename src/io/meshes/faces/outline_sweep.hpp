// cut_by_sweep(): cuts the inside of an outline into triangles, also of an outline that touches itself.
//
// - Corners at one place of the plane are one node. An edge that touches a node between its ends is divided there. Edges along each
//   other are one bundle, with the sum of their directions as its weight.
// - A line sweeps over the plane from left to right, and over each vertical line upward. The bundles that it crosses are in their order
//   from below. The winding number of the place above a bundle is that below plus the weight.
// - All winding numbers of an outline that does not cross itself are 0 or 1 (0 or -1, if it is clockwise). Its inside is where they
//   are not 0. Edges there and back, such as bridges to holes, have the weight 0, and divide the inside.
// - Neighbours on the line are tested as in the search for crossings of segments, so the first crossing is found before its place.
// - The triangles' edges cancel except those of the outline: the mesh of a closed surface stays closed. Where an edge is divided,
//   triangles without area lie between it and its parts. Corners at one place of the plane, but not of space, are joined by triangles
//   without area in the plane.
//
// Complexity: O(n log n) for n corners.
// Source: Shamos, Hoey, "Geometric intersection problems", 1976, for the crossings; monotone_pieces.hpp for the triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "io/meshes/faces/plane_outline.hpp"

namespace octopair::io {

/// Appends the triangles of an outline, by the positions of its corners, in the sense of the outline. Returns false if the outline
/// crosses itself or folds; then it appends nothing.
/// Throws: Error{cancelled}.
bool cut_by_sweep(const PlaneOutline& outline, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace octopair::io
