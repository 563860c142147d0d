// Reads JSON scenes, objects with shapes and poses (docs/formats.md), and the mesh files that they name.
//
// The loaded scene has no boxes. boxes_of() (octopair/shapes.hpp) computes the boxes from the shapes.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "io/loaded_scene.hpp"
#include "octopair/shapes.hpp"

namespace octopair::io {

/// Returns the mesh in the file `name`. `name` is the text in the scene. Throws: Error.
using MeshLoader = std::function<shape::Mesh(const std::string& name)>;

/// Returns the shape that `value`, an object of a scene, describes. `place` is the beginning of messages.
/// Throws: Error{bad_input}; what `load_mesh` throws, with `place` before its message; Error{cancelled}.
shape::Any json_shape(const nlohmann::json& value, const std::string& place, const MeshLoader& load_mesh,
                      const std::stop_token& stop);

/// Parses the scene in `text`. `file` is the name that messages begin with.
/// Throws: Error{bad_input} that names the object and the key; what `load_mesh` throws; Error{cancelled} soon after a stop
/// request.
LoadedScene parse_json_scene(std::string_view text, std::string_view file, const MeshLoader& load_mesh,
                             const std::stop_token& stop = {});

/// Reads a JSON scene. Names of mesh files are relative to the scene's directory. All triangles of a mesh file become one
/// mesh.
/// Throws: what parse_json_scene() throws; Error{io_failed}.
LoadedScene read_json_scene(const std::string& path, const std::stop_token& stop = {});

}  // namespace octopair::io
