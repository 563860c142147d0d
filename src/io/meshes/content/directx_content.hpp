// Finds in a DirectX file (.x) what Assimp 5.2 reads wrongly, and corrects it where the meaning is certain.
//
// These are the faults of Assimp:
//
// - A corner beyond the vertices is left out of its face. Faces with a material beyond the list are lost.
// - A reference in braces swallows the object after it.
// - A comma between whole numbers of a matrix is a decimal point.
// - Meshes outside all frames are placed by the only frame, and replace its meshes.
// - An unnamed frame with a mesh is joined to its parent, and the frames in it are lost.
//
// Binary and compressed files are not checked.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line, as check_mesh_content().
MeshContent correct_directx(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
