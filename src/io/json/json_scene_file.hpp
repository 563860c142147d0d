// Reads JSON scene files and the mesh files that they name.
#pragma once

#include <stop_token>
#include <string>

#include "io/loaded_scene.hpp"

namespace octopair::io {

/// Reads a JSON scene. Names of mesh files are relative to the scene's directory. All triangles of a mesh file become one
/// mesh.
/// Throws: what parse_json_scene() throws; Error{io_failed}.
LoadedScene read_json_scene(const std::string& path, const std::stop_token& stop = {});

}  // namespace octopair::io
