// A shape of a JSON scene (docs/formats.md).
#pragma once

#include <functional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "octopair/shapes.hpp"

namespace octopair::io {

/// The mesh in the file that a scene names, as the scene writes its name. Throws Error.
using MeshLoader = std::function<shape::Mesh(const std::string& name)>;

/// Throws Error{bad_input} that begins with `place`, and what `load_mesh` throws with the place before it.
shape::Any json_shape(const nlohmann::json& value, const std::string& place, const MeshLoader& load_mesh);

}  // namespace octopair::io
