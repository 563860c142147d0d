// Converts a mesh file for the narrow phase: to the shapes of its nodes, or to the triangles of all nodes in the world.
//
// - Nodes with the same list of meshes share a shape.
// - A shape has the triangles of all meshes of its node, in the order of `--objects triangle`, and the vertices that these
//   triangles use.
// - A node that has only points and lines gets a mesh without triangles.
#pragma once

#include "io/loaded_shapes.hpp"
#include "io/meshes/mesh_file.hpp"

namespace octopair::io {

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

}  // namespace octopair::io
