// Finds in an AC3D file what Assimp 5.2 reads wrongly, and moves lines to their places.
//
// These are the faults of Assimp:
//
// - A corner beyond the vertices becomes the first vertex. A surface with a material beyond the list is lost.
// - A line of data that begins with a keyword is read as the model.
// - The place of an object with surfaces does not move its children and its lines. A rotation turns it, too.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line, as check_mesh_content().
MeshContent correct_ac3d(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
