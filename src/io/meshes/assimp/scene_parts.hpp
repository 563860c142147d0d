// Makes the parts of a scene from a file that Assimp imported (mesh_file.hpp): details, shapes, triangles, warnings and axes.
//
// Details of an instance:
//
//   all formats   label: the name of the node. parent: the name of the nearest node above it that has one. material: the
//                 names of the materials of its meshes.
//   IFC           An element is a node that Assimp names TYPE_NAME_GLOBALID. An instance belongs to the nearest element at or
//                 above its node: label, type and id are those of the element. parent: the nearest element above that one.
//                 level: the nearest IfcBuildingStorey.
//
// Shapes:
//
// - Nodes with the same list of meshes share a shape.
// - A shape has the triangles of all meshes of its node, in the order of `--objects triangle`, and the vertices that these
//   triangles use.
// - A node that has only points and lines gets a mesh without triangles.
#pragma once

#include <string>
#include <vector>

#include "io/loaded_scene.hpp"
#include "io/meshes/assimp/mesh_file.hpp"
#include "io/object_details.hpp"

namespace octopair::io {

/// Returns the details of all instances, in their order.
ObjectDetails details_of(const MeshFile& file);

/// Returns the relations of the elements of an IFC file, and the element of each instance.
ObjectRelations relations_of(const MeshFile& file);

/// Returns the shapes and poses of all instances.
/// Requires: the file was read with `triangles`.
/// Throws: Error{resource_limit} if a shape has too many vertices for 32-bit indices.
LoadedShapes shapes_of(const MeshFile& file);

/// Returns the triangles of all instances, in the world.
/// Requires: the file was read with `triangles`.
/// Throws: Error{bad_input} for a vertex beyond the range of float32, because boxes of triangles are float32.
LoadedTriangles triangles_of(const MeshFile& file);

/// Returns all triangles of the file, in the world, as one mesh.
/// Requires: the file was read with `triangles`.
/// Throws: Error{bad_input} for a vertex that is not finite; Error{resource_limit} as shapes_of() does.
shape::Mesh whole_mesh_of(const MeshFile& file);

/// Returns warnings about the file, each a line "FILE: ...": whether octopair checks the format, and the content that was not read.
std::vector<std::string> import_warnings(const MeshFile& file);

/// Counts the elements of an IFC file, and those of them that have an instance.
ElementCounts elements_of(const MeshFile& file);

/// Returns the content that was not read, for LoadedScene::not_read.
std::vector<std::string> left_out_of(const MeshFile& file);

}  // namespace octopair::io
