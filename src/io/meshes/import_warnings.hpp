// Warnings about a file that Assimp imported: that octopair does not vouch for the format, and what was not read.
#pragma once

#include <string>
#include <vector>

#include "io/meshes/mesh_file.hpp"

namespace octopair::io {

/// Returns the warnings, each a line "FILE: ...".
std::vector<std::string> import_warnings(const MeshFile& file);

/// Returns what was not read, for LoadedScene::not_read.
std::vector<std::string> left_out_of(const MeshFile& file);

/// Returns the axes and the unit of a file: those of its format, or for FBX those that the file has.
SceneSpace space_of(const MeshFile& file);

}  // namespace octopair::io
