// Leaves of a mesh's bounding hierarchy: pairs of leaves within reach, and the triangles of a leaf in the world.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "geometry/rounding.hpp"
#include "narrow_phase/mesh/mesh_walk.hpp"

namespace octopair {

/// Returns `reach` for a MeshWalk: rounded up, so that no pair within reach is lost.
inline float reach_above(double reach) { return rounding::next_above(float(reach)); }

/// Calls leaves(node of a, node of b) for all leaves whose distance may be at most `reach`, until `leaves` returns false.
template <typename Leaves>
void visit_leaves(const PosedMesh& a, const PosedMesh& b, float reach, const Leaves& leaves) {
    if (a.tree.nodes.empty() || b.tree.nodes.empty()) return;
    MeshWalk walk(a, b, reach);
    // The first search asks for one pair of leaves only, because often the caller needs no further pair.
    std::array<NodePair, 16> some;
    for (std::size_t room = 1;; room = some.size()) {
        const unsigned found = next_leaves(walk, std::span(some).first(room));
        for (unsigned i = 0; i < found; ++i) {
            if (!leaves(a.tree.nodes[some[i].a], b.tree.nodes[some[i].b])) return;
        }
        if (found < room) return;
    }
}

/// Triangles of a leaf in the world, with their boxes.
class WorldLeaf {
public:
    WorldLeaf(const PosedMesh& mesh, const MeshNode& leaf) : first_(leaf.first), count_(leaf.count) {
        for (std::uint32_t i = 0; i < count_; ++i) {
            triangles_[i] = mesh.tree.world_triangle(mesh.pose, first_ + i);
            for (int axis = 0; axis < 3; ++axis) {
                const auto& [p, q, r] = triangles_[i];
                boxes_[i].min[axis] = std::min({p[axis], q[axis], r[axis]});
                boxes_[i].max[axis] = std::max({p[axis], q[axis], r[axis]});
            }
        }
    }

    std::uint32_t count() const { return count_; }
    /// Returns the place of triangle i in the tree's order.
    std::uint32_t place(std::uint32_t i) const { return first_ + i; }
    const Triangle3d& triangle(std::uint32_t i) const { return triangles_[i]; }
    const Box3d& box(std::uint32_t i) const { return boxes_[i]; }

private:
    std::uint32_t first_, count_;
    std::array<Triangle3d, MeshTree::leaf_size> triangles_;
    std::array<Box3d, MeshTree::leaf_size> boxes_;
};

inline bool boxes_overlap(const Box3d& a, const Box3d& b) {
    bool overlap = true;
    for (int axis = 0; axis < 3; ++axis) overlap &= a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis];
    return overlap;
}

}  // namespace octopair
