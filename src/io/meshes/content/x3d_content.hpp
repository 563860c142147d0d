// Writes an X3D file in a form that Assimp 5.2 reads rightly.
//
// These are the faults of Assimp:
//
// - After an empty group, and after a group with USE, nodes are placed in the wrong group or lost.
// - A comma between numbers ends the number before it, and the number after it is lost.
// - The axis of a rotation must have the length 1.
// - A Cone is upside down. A Cylinder has 30 sides, so it is too narrow along z. Quads and TriangleStripSet are not known, nor groups such as Anchor.
// - Metadata counts as a child of a Switch.
// - An Extrusion along a straight spine ignores its direction. Its orientations turn around the axes of the world.
// - Indices beyond the points, and grids with too few heights, are read from other memory.
//
// So uses are replaced by what they refer to, numbers are written with spaces between them, and only groups and geometry are written.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line, as check_mesh_content().
MeshContent correct_x3d(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
