// Scenes from mesh files of simple formats (plain_mesh.hpp): one object for each mesh of the file, or for each triangle.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>

#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::io {

/// Returns whether files with this ending have a simple format. Requires: `ending` is in lower case.
bool is_plain_ending(std::string_view ending);

/// Reads a file of a simple format. The name of an object is that of the file and, if the file has several meshes or names them, "/"
/// and the name of the mesh or "#" and its position.
/// Throws: what the parsers throw (plain_mesh.hpp); Error{io_failed, resource_limit}.
LoadedScene read_plain_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop);

/// Reads all meshes of such a file as one, for a scene that names it. Adds the file's LoadedScene::largest_rounded and warnings to
/// `scene`.
shape::Mesh read_plain_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop);

}  // namespace octopair::io
