// Parses one shape of a JSON scene (docs/formats.md).
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "octopair/shapes.hpp"

namespace octopair::io {

/// Returns the mesh in the file `name`. `name` is the text in the scene. Throws: Error.
using MeshLoader = std::function<shape::Mesh(const std::string& name)>;

/// Returns the shape that `value` describes. `place` is the beginning of messages.
/// Throws: Error{bad_input}; what `load_mesh` throws, with `place` before its message; Error{cancelled}.
shape::Any json_shape(const nlohmann::json& value, const std::string& place, const MeshLoader& load_mesh,
                      const std::stop_token& stop);

}  // namespace octopair::io
