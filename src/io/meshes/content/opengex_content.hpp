// Finds in an OpenGEX file what Assimp 5.2 reads wrongly or leaves out.
//
// These are the faults of Assimp:
//
// - Structures Node and BoneNode are left out, with all that is in them.
// - Translation, Rotation and Scale are ignored. Of several transforms of a node, the last one counts.
// - Of several index arrays of a mesh, the last one counts. Each face has its first three corners.
// - Hexadecimal indices are 0. Corners beyond the vertices are read from other memory.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line, as check_mesh_content().
MeshContent check_opengex(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
