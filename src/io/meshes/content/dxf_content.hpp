// Writes a DXF file as faces and lines, which Assimp 5.2 reads rightly.
//
// These are the faults of Assimp:
//
// - A block is inserted without its rotation, rows, columns and direction of extrusion, and its position is scaled. Blocks in blocks are lost.
// - A text that begins with a brace swallows what follows. So does a POLYLINE without a VERTEX.
// - A corner of a polyface mesh is lost if the edge after it is invisible. Meshes of M x N points are lines. Every second edge of a line is lost.
// - Entities of the paper (layouts) are read as the model.
//
// So blocks are replaced by their entities, polylines by faces or lines, and all other entities are left out. An object is a layer.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line, as check_mesh_content().
MeshContent correct_dxf(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
