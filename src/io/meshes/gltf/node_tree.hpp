// NodeTree: the nodes of a scene of a glTF file that have meshes, with names and poses.
//
// - The scene is the default scene of the file, or the first one. A file without scenes gives all nodes that have no parent.
// - Instances are in pre-order of their nodes. The copies of a node (EXT_mesh_gpu_instancing) follow each other.
// - Every node has at most one parent: cycles and nodes with two parents are refused.
// - A name is the path of the node, joined by "/". If the scene has several roots, the path begins with ROOT. A node without a name
//   has the name of its mesh, or else "#" and its position among its parent's children. If siblings without names have meshes of equal
//   names, "#" and the position follow the name. Copy i of a node is NODE/#i.
// - A rotation becomes a matrix in float64, in which quarter turns are exact. A quaternion may have any length but 0.
//
// Source: Khronos, glTF 2.0 specification, section 3.5.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/meshes/bounded_pose.hpp"
#include "io/meshes/gltf/gltf_file.hpp"

namespace octopair::io::gltf {

/// A mesh in the world.
struct Instance {
    std::size_t node;  ///< index in NodeTree::nodes()
    std::string name;
    BoundedPose pose;  ///< product of the transforms along the path
    double translations =
        0;  ///< sum of the largest coordinates of the translations along the path, in the unit of the world
    std::uint64_t mesh = 0;  ///< index in the array "meshes"
};

/// A node of the scene.
struct Node {
    static constexpr std::size_t no_parent = ~std::size_t(0);

    std::uint64_t number;     ///< index in the array "nodes"
    std::size_t parent;       ///< index in NodeTree::nodes(), or no_parent for a root
    std::size_t named_above;  ///< nearest node above this node that has a label, or no_parent
    std::string path;
    std::string label;  ///< name of the node or its mesh; empty if neither has one
    BoundedPose pose;
    double translations = 0;
    bool has_skin = false;
    bool is_hidden = false;  ///< true if the file hides the node, or a node above it
};

class NodeTree {
public:
    /// Throws: Error{bad_input} that names the node; Error{resource_limit, cancelled}; what Accessor throws.
    explicit NodeTree(GltfFile& file);

    const std::vector<Instance>& instances() const { return instances_; }
    std::vector<Instance>& instances() { return instances_; }
    const std::vector<Node>& nodes() const { return nodes_; }
    /// Returns the label of the nearest labelled node above a node; empty if there is none.
    std::string_view parent_label(std::size_t node) const;
    /// Returns whether the scene has several roots.
    bool has_added_root() const { return roots_ > 1; }
    /// Returns a note for the user if the file has scenes that are not read; otherwise an empty text.
    const std::string& note() const { return note_; }

private:
    struct Waiting;
    std::vector<std::uint64_t> find_roots();
    std::string mesh_name(const JsonFields& node) const;
    void push(const std::vector<std::uint64_t>& siblings, std::size_t parent, std::vector<Waiting>& stack) const;
    void add(const Waiting& waiting, std::vector<Waiting>& stack);
    void add_copies(const JsonFields& fields, std::size_t node, std::uint64_t mesh, const nlohmann::json& extension);

    GltfFile& file_;
    std::vector<Node> nodes_;
    std::vector<Instance> instances_;
    std::vector<bool> visited_;
    std::size_t roots_ = 0;
    std::string note_;
};

}  // namespace octopair::io::gltf
