// Details of the instances of a mesh file that Assimp imports (mesh_file.hpp).
//
//   all formats   label: the name of the node. parent: the name of the nearest node above it that has one. material: the
//                 names of the materials of its meshes.
//   IFC           An element is a node that Assimp names TYPE_NAME_GLOBALID. An instance belongs to the nearest element at or
//                 above its node: label, type and id are those of the element. parent: the nearest element above that one.
//                 level: the nearest IfcBuildingStorey.
#pragma once

#include "io/meshes/mesh_file.hpp"
#include "io/object_details.hpp"

namespace octopair::io {

/// Returns the details of all instances, in their order.
ObjectDetails details_of(const MeshFile& file);

}  // namespace octopair::io
