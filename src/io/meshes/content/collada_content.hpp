// Writes a COLLADA file in a form that Assimp 5.2 reads rightly.
//
// These are the faults of Assimp:
//
// - <skew> is ignored. The axis of <rotate> must have the length 1, and the up of <lookat> must be perpendicular.
// - A comma in an index is an endless loop. Negative indices are read as 0.
// - A fan of triangles becomes one polygon. A primitive whose count is missing is empty. A strip with fewer than three corners crashes it.
// - Values of an accessor without the names X, Y and Z are all the first one.
// - <extra> in a primitive is refused. Texts end at the first comment.
// - Instances of nodes and geometries that are in other files, or missing, or within a node of a library, are lost.
// - If two instances of a geometry share some materials, later triangles of the second one get the vertices of other triangles.
// - White space around the name of the up axis makes it y.
//
// So nodes replace their instances, transforms are written as numbers that Assimp understands, and meshes have only positions.
#pragma once

#include <string>
#include <string_view>

#include "io/meshes/content/mesh_content.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} with the line, as check_mesh_content().
MeshContent correct_collada(const std::string& path, std::string_view bytes);

}  // namespace octopair::io
