// MeshTree: bounding hierarchy of a mesh, a binary tree of boxes in the mesh's own coordinates. Built once for all instances.
//
// Nodes     Node 0 is the root. The two children of an inner node are adjacent.
// Triangles `triangles` holds the mesh's triangles in another order. The triangles below a node are consecutive in it.
// Boxes     A node's box contains all corners of its triangles, rounding included. Boxes are float32, relative to `origin`,
//           so they stay tight for a mesh far from the origin of its coordinates.
// Source    Wald 2007, "On fast construction of SAH-based bounding volume hierarchies" (binning).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_solid.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

/// The layout allows SIMD loads of four numbers from `centre` and `half`.
struct alignas(32) MeshNode {
    float centre[3];      ///< relative to MeshTree::origin
    std::uint32_t first;  ///< leaf: its first triangle; inner node: its first child
    float half[3];        ///< half extents; infinite beyond the range of float32
    std::uint32_t count;  ///< leaf: number of triangles; inner node: 0

    bool is_leaf() const { return count > 0; }
};

/// Connected components of a mesh. Triangles are connected by shared corners, compared by position.
struct MeshParts {
    std::vector<Point3d> corners;  ///< one corner of each part
    /// Kind of the part that a triangle belongs to: not closed, closed and consistently oriented, or closed only.
    enum class Side : std::uint8_t { open, oriented, unoriented };
    std::vector<Side> sides;             ///< by triangle, in the tree's order
    std::vector<std::uint32_t> numbers;  ///< by triangle, in the tree's order: the index of its part in `corners`
    bool any_closed = false;

    /// True for a mesh without triangles.
    bool all_closed() const { return std::find(sides.begin(), sides.end(), Side::open) == sides.end(); }
};

struct MeshTree {
    static constexpr std::uint32_t leaf_size = 4;
    static constexpr std::uint32_t max_depth = 96;

    Point3d origin = {};
    std::vector<Point3d> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint32_t> numbers;  ///< index of each triangle in the given mesh
    std::vector<MeshNode> nodes;         ///< empty for a mesh without triangles
    MeshParts parts;
    /// Convex hull of a closed mesh of few triangles that is convex but for rounding of its vertices; of other meshes none exists.
    ConvexSolid solid;
    double solid_error = 0;  ///< how far vertices are above the planes of triangles, at most; 0: the mesh is convex

    Triangle3d world_triangle(const Pose& pose, std::uint32_t triangle) const {
        const auto& [a, b, c] = triangles[triangle];
        return {vector::posed(pose, vertices[a]), vector::posed(pose, vertices[b]), vector::posed(pose, vertices[c])};
    }
};

/// Requires: indices are in range, and vertices are finite.
std::shared_ptr<const MeshTree> make_mesh_tree(const shape::Mesh& mesh);

/// Returns a tree of one node with the given box and without triangles, to test a mesh against another kind of object.
MeshTree make_box_tree(const Box3d& box);

/// Sets solid and solid_error. Tests few triangles only, because the test takes quadratic time.
/// Requires: vertices, triangles and parts of `tree` are set.
void set_convex_solid(MeshTree& tree);

/// Returns the parts of the tree's mesh. Requires: vertices and triangles of `tree` are set.
MeshParts find_parts(const MeshTree& tree);

}  // namespace octopair
