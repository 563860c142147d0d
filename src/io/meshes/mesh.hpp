// Mesh files, read by Assimp: each node that shows a mesh as an object, or each triangle.
//
//   node      its name is the node path from the root, joined by "/"; a node without a name gives "#" and its position
//             among its parent's children. Its box is float64: it holds the vertices that faces of its meshes use (all
//             vertices, where a mesh has no faces), posed by the transforms along the path, and is rounded outward.
//   triangle  node by node, mesh by mesh, face by face; faces with more corners are cut into triangles, points and
//             lines are left out. Its box is float32: posed vertices rounded once, then their min and max. No names.
//
// With shapes: nodes have theirs beside their boxes; triangles have no boxes, but their places in float64 and the names of
// the nodes that own them.
//
// Vertices are taken as Assimp gives them: not merged, not reordered. Bones and animations are left out.
#pragma once

#include <string>
#include <string_view>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::io {

/// True if Assimp reads files with such an ending (as in ".obj", in lower case).
bool is_mesh_ending(std::string_view ending);

/// Throws Error{bad_input} with Assimp's words if it refuses the file, and for a vertex that is not finite;
/// Error{io_failed, resource_limit}.
LoadedScene read_mesh_scene(const std::string& path, const SceneContent& content);

}  // namespace octopair::io
