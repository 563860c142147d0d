// JSON scenes in files, with the mesh files that they name.
#pragma once

#include <stop_token>
#include <string>

#include "io/loaded_scene.hpp"

namespace octopair::io {

/// Names of mesh files are relative to the scene's directory; all that such a file shows becomes one mesh. Throws as
/// parse_json_scene does, and Error{io_failed}.
LoadedScene read_json_scene(const std::string& path, const std::stop_token& stop = {});

}  // namespace octopair::io
