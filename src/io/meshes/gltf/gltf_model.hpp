// GltfModel: the instances of a glTF file with their decoded meshes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/meshes/gltf/gltf_file.hpp"
#include "io/meshes/gltf/gltf_mesh.hpp"
#include "io/meshes/gltf/node_tree.hpp"

namespace octopair::io::gltf {

class GltfModel {
public:
    /// Reads all meshes that instances have, each once. `progress`: called with the part that is read, from 0 to 1; or empty.
    /// Throws: Error{bad_input, io_failed, resource_limit, cancelled}.
    GltfModel(GltfFile& file, const std::function<void(double)>& progress);

    GltfFile& file() const { return file_; }
    const NodeTree& tree() const { return tree_; }
    /// Returns the instances whose meshes have vertices.
    const std::vector<Instance>& instances() const { return tree_.instances(); }
    std::vector<Instance>& instances() { return tree_.instances(); }
    GltfMesh& mesh(const Instance& instance) { return meshes_[numbers_.at(instance.mesh)]; }
    const GltfMesh& mesh(const Instance& instance) const { return meshes_[numbers_.at(instance.mesh)]; }

    /// Returns LoadedScene::largest_rounded.
    double largest_rounded() const;
    /// Returns what a user should know, each one line "FILE: ...".
    std::vector<std::string> warnings() const;

private:
    std::string warning_of_incomplete_faces() const;
    std::string warning_of_motion() const;
    std::string warning_of_hidden_nodes() const;
    std::string warning_of_points() const;
    std::string warning_of_steps() const;

    GltfFile& file_;
    NodeTree tree_;
    std::vector<GltfMesh> meshes_;
    std::unordered_map<std::uint64_t, std::size_t> numbers_;  // index in the array "meshes" -> index in meshes_
};

}  // namespace octopair::io::gltf
