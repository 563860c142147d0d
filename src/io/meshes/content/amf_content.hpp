// Writes an AMF file in a form that Assimp 5.2 reads rightly.
//
// These are the faults of Assimp:
//
// - Only the first volume of an object is read, and the last mesh.
// - A number ends at a comma. A vertex without coordinates is left out, so that all indices after it are wrong.
// - Objects without an id, or with one id, replace each other.
// - The angles of an instance are taken for a translation.
//
// So all volumes of an object are written as one, in the vertices of one mesh. Colours, textures and materials are not written.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line, as check_mesh_content().
MeshContent correct_amf(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
