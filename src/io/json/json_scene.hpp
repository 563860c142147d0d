// Reads JSON scenes, objects with shapes and poses (docs/formats.md), and the mesh files that they name.
//
// The loaded scene has no boxes. boxes_of() (octopair/shapes.hpp) computes the boxes from the shapes.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>

#include "io/json/json_shape.hpp"
#include "io/loaded_scene.hpp"

namespace octopair::io {

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
