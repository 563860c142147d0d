// Writes an XGL file in a form that Assimp 5.2 reads rightly.
//
// These are the faults of Assimp:
//
// - All transforms are ignored, and so are references to objects.
// - The comma after a whole number is a decimal point.
//
// So each object gets meshes of its own, with vertices in their places, and without colours and normals.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line, as check_mesh_content().
MeshContent correct_xgl(const std::string& path, std::string_view bytes);

/// As correct_xgl(), for a compressed file (.zgl).
MeshContent correct_zgl(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
