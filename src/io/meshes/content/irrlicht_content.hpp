// Refuses scenes of Irrlicht (.irr): Assimp 5.2 finds no object in them, and says nothing.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line of the first object.
MeshContent check_irrlicht(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
