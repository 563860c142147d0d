// Reads mesh files through Assimp. The folders plain/ and gltf/ have readers that need no Assimp. An object is a node with meshes, or
// a triangle.
//
//   node      The name is the node path from the root, joined by "/". In the path, "#" and the position among its parent's children
//             stand for a node without a name. The box is float64 and rounded outward. It encloses the vertices that faces use
//             (all vertices, if a mesh has no faces), posed by the transforms along the path.
//   triangle  The order is node by node, mesh by mesh, face by face. Faces with more than three corners are cut into triangles.
//             Points and lines are left out. The box is float32: posed vertices are rounded once, and then the box encloses them.
//             Triangles have no names.
//
// With SceneContent::shapes, nodes have shapes besides boxes. Triangles then have float64 corners and the names of their
// nodes, and no boxes.
//
// A new format needs an entry in io/formats/format_table.cpp. If Assimp cannot read it, io/scene_reader.cpp must call a reader for it.
//
// Vertices keep the order of Assimp and are not merged. Bones and animations are ignored.
#pragma once

#include <string>
#include <string_view>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::io {

/// Returns whether Assimp reads files with the ending `ending`, for example ".obj". Requires: `ending` is in lower case.
bool is_mesh_ending(std::string_view ending);

/// Reads a mesh file.
/// Throws: Error{bad_input} with Assimp's message if Assimp refuses the file, and for a vertex that is not finite;
/// Error{io_failed, resource_limit}.
LoadedScene read_mesh_scene(const std::string& path, const SceneContent& content);

}  // namespace octopair::io
