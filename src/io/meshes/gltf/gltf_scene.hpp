// Scenes from glTF 2.0 and GLB files: one object for each node with a mesh and each copy of such a node, or for each triangle.
//
// - Vertices are exact in float64. Transforms are in float64, and boxes are rounded outward (io/meshes/bounded_pose.hpp).
// - Nodes with the same mesh share a shape.
// - Skins, morph targets and animations are not applied. A warning says so.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "base/memory.hpp"
#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::io {

/// Returns whether files with this ending are glTF. Requires: `ending` is in lower case.
bool is_gltf_ending(std::string_view ending);

/// Returns whether Assimp may have to read a glTF file: it is of glTF 1.0, or has meshes that are compressed with Draco. The functions
/// below then decide. Returns false if the file cannot be read.
bool may_be_gltf_for_assimp(const std::string& path);

/// Reads a glTF file. Returns nothing if Assimp must read it.
/// Throws: Error{bad_input} that names the object in the file; Error{io_failed, resource_limit, cancelled}.
std::optional<LoadedScene> read_gltf_scene(const std::string& path, const SceneContent& content,
                                           const std::stop_token& stop);
/// Like read_gltf_scene(), with the content of the file.
std::optional<LoadedScene> parse_gltf_scene(const std::string& path, Buffer<std::byte> bytes,
                                            const SceneContent& content, const std::stop_token& stop);

/// Reads all triangles of a glTF file as one mesh, in the world. Returns nothing if Assimp must read it. Adds the file's
/// LoadedScene::largest_rounded and warnings to `scene`.
std::optional<shape::Mesh> read_gltf_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop);

}  // namespace octopair::io
