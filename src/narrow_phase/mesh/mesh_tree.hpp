// A mesh's bounding hierarchy: a binary tree of boxes in the mesh's own space, made once and shared by its instances.
//
// Node 0 is the root; the two children of an inner node stand side by side. The triangles below a node are consecutive in
// `triangles`, which are the mesh's in another order. A node's box holds all corners of its triangles, whatever was
// rounded. Boxes are float32, about an origin of their own, so that a mesh that was drawn far out keeps tight ones.
//
// Source: Wald 2007, "On fast construction of SAH-based bounding volume hierarchies" (binning).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/vector.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

/// Laid out so that four numbers can be fetched at once from `centre` and `half`.
struct alignas(32) MeshNode {
    float centre[3];      ///< about MeshTree::origin
    std::uint32_t first;  ///< of a leaf: its first triangle; of an inner node: its first child
    float half[3];        ///< half extents; infinite where float32 does not reach
    std::uint32_t count;  ///< triangles of a leaf; 0 of an inner node

    bool is_leaf() const { return count > 0; }
};

/// Parts of a mesh: what hangs together by shared corners, by position.
struct MeshParts {
    /// A corner of each part.
    std::vector<Point3d> corners;
    /// Of each triangle, in the tree's order: how it bounds an inside.
    enum class Side : std::uint8_t { open, oriented, unoriented };
    std::vector<Side> sides;
    bool any_closed = false;
};

struct MeshTree {
    static constexpr std::uint32_t leaf_size = 4;
    static constexpr std::uint32_t most_depth = 96;

    Point3d origin = {};
    std::vector<Point3d> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint32_t> numbers;  ///< of each triangle: its place in the mesh as it was given
    std::vector<MeshNode> nodes;         ///< none of a mesh without triangles
    MeshParts parts;

    Triangle3d world_triangle(const Pose& pose, std::uint32_t triangle) const {
        const auto& [a, b, c] = triangles[triangle];
        return {vector::posed(pose, vertices[a]), vector::posed(pose, vertices[b]), vector::posed(pose, vertices[c])};
    }
};

/// Indices must be in range, and vertices finite.
std::shared_ptr<const MeshTree> make_mesh_tree(const shape::Mesh& mesh);

/// One node that holds a box, and no triangles: what is not a mesh is met by one of these.
MeshTree make_box_tree(const Box3d& box);

/// Of a tree whose triangles are in order.
MeshParts find_parts(const MeshTree& tree);

}  // namespace octopair
