// A mesh file in memory: the nodes of it that show something, with names, poses and vertices.
//
// A node shows the vertices that faces of its meshes use (all vertices, where a mesh has no faces). One that shows none
// is no object.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include "io/meshes/bounded_pose.hpp"

namespace octopair::io {

/// A node that shows something.
struct MeshInstance {
    const aiNode* node;
    std::string name;  ///< the path to it
    BoundedPose pose;  ///< the transforms along the path

    std::span<const unsigned> meshes() const { return {node->mMeshes, node->mNumMeshes}; }
};

class MeshFile {
public:
    /// `triangles`: faces with more corners are cut into triangles. Throws Error{bad_input} with Assimp's words if it
    /// refuses the file, and for a face of a vertex that is not there; Error{io_failed}.
    MeshFile(const std::string& path, bool triangles);

    /// In pre-order.
    const std::vector<MeshInstance>& nodes() const { return nodes_; }
    const aiMesh& mesh(unsigned number) const { return *scene_->mMeshes[number]; }
    /// What is shown of a mesh that a node names, each vertex once, in the order of their first use.
    const std::vector<unsigned>& shown_vertices(unsigned mesh) const { return *shown_[mesh]; }

    static Point3d vertex(const aiMesh& mesh, unsigned index) {
        const aiVector3D& place = mesh.mVertices[index];
        return {double(place.x), double(place.y), double(place.z)};
    }
    /// Throws Error{bad_input} that names the node and the vertex, if it or its place in the world is not finite.
    BoundedPoint posed_vertex(const MeshInstance& node, const aiMesh& mesh, unsigned index) const;
    [[noreturn]] void refuse_vertex(const MeshInstance& node, unsigned index, double value) const;

private:
    const aiScene& import(const std::string& path, bool triangles);
    bool shows_something(const MeshInstance& node);
    std::vector<unsigned> find_shown(const MeshInstance& node, const aiMesh& mesh) const;

    std::string path_;
    Assimp::Importer importer_;
    const aiScene* scene_;
    std::vector<MeshInstance> nodes_;
    std::vector<std::optional<std::vector<unsigned>>> shown_;  // of each mesh, once a node was seen to name it
};

}  // namespace octopair::io
