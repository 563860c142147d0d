// Scenes of primitives in JSON: objects with shapes and poses (docs/formats.md).
//
// They have no boxes: these are made of the shapes, by boxes_of (octopair/shapes.hpp).
#pragma once

#include <stop_token>
#include <string_view>

#include "io/json/json_shape.hpp"
#include "io/loaded_scene.hpp"

namespace octopair::io {

/// Throws Error{bad_input} that begins with `file` and names the object and the key; what `load_mesh` throws;
/// Error{cancelled} soon after a stop request.
LoadedScene parse_json_scene(std::string_view text, std::string_view file, const MeshLoader& load_mesh,
                             const std::stop_token& stop = {});

}  // namespace octopair::io
