// PlacedMeshes: the meshes of a file, and their objects: meshes with poses in the world. scene_of() makes scenes of them.
//
// - Vertices are exact in float64. Boxes are rounded outward (bounded_pose.hpp).
// - Objects with the same mesh share a shape.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/loaded_scene.hpp"
#include "io/meshes/bounded_pose.hpp"
#include "io/meshes/read_budget.hpp"
#include "io/scene_reader.hpp"
#include "octopair/shapes.hpp"

namespace octopair::io {

/// Removes the vertices that no corner refers to. The other vertices keep their order. Renumbers `corners`, the indices of vertices.
void remove_unused_vertices(std::vector<Point3d>& vertices, std::span<std::uint32_t> corners);

/// A mesh that several objects may have.
struct SharedMesh {
    shape::Mesh triangles;
    std::vector<Point3d> loose;  ///< vertices that no triangle has, but that boxes enclose
    std::set<std::string> materials;

    bool empty() const { return triangles.vertices.empty() && loose.empty(); }
};

/// An object: a mesh in the world.
struct PlacedMesh {
    std::string name;
    std::string_view label, parent_label;  ///< details, borrowed from the reader's tree
    BoundedPose pose;
    std::size_t mesh;      ///< index in PlacedMeshes::meshes
    std::uint64_t parent;  ///< number of the node above; objects with the same number have the same parent
};

struct PlacedMeshes {
    std::string_view noun;  ///< the word of the format for an object, for messages, for example "node"
    std::vector<SharedMesh> meshes;
    std::vector<PlacedMesh> objects;
    std::string unit = {};  ///< unit of the vertices and the poses; empty if unknown
};

/// Returns the scene of all objects, or of all their triangles, in the unit of `content`. The reader sets LoadedScene::largest_rounded,
/// warnings and the axis. Takes the meshes and the names.
/// Throws: Error{bad_input} that names the object, if a vertex in the world is not finite, or for triangles beyond the range of float32;
/// Error{resource_limit, cancelled}.
LoadedScene scene_of(PlacedMeshes& placed, const SceneContent& content, ReadBudget& budget);

/// Returns the triangles of all objects as one mesh, in the world. Throws: as scene_of().
shape::Mesh whole_mesh_of(const PlacedMeshes& placed, ReadBudget& budget);

}  // namespace octopair::io
