// What the exact stages need of a mesh file: the shapes of its nodes, or the triangles of all nodes in the world.
//
// Nodes that show the same meshes share a shape, which is made of the triangles of them all, in the order of `--objects
// triangle`, and of the vertices that these use. A node of points and lines alone has a mesh without triangles.
#pragma once

#include "io/loaded_shapes.hpp"
#include "io/meshes/mesh_file.hpp"

namespace octopair::io {

/// Of a file that was read with `triangles`. Throws Error{resource_limit} where vertices are too many for 32-bit numbers.
LoadedShapes shapes_of(const MeshFile& file);

/// Throws Error{bad_input} for a vertex beyond float32, as boxes of triangles do.
LoadedTriangles triangles_of(const MeshFile& file);

/// All triangles of the file, posed, as one mesh. Throws what the others throw.
shape::Mesh whole_mesh_of(const MeshFile& file);

}  // namespace octopair::io
