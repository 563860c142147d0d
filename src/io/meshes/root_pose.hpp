// Poses of Assimp's nodes, with the axes of the file.
//
// Assimp turns and mirrors some formats to its own axes (formats/format_table.hpp). The root pose undoes that, so coordinates are those of
// the file. COLLADA files keep Assimp's axes, because their unit and axes are those of glTF then.
#pragma once

#include <assimp/scene.h>

#include "io/formats.hpp"
#include "io/meshes/bounded_pose.hpp"

namespace octopair::io {

BoundedPose pose_of(const aiNode& node);

/// Returns the pose of the root node of a file.
BoundedPose root_pose(const aiNode& root, const KnownFormat& known);

}  // namespace octopair::io
