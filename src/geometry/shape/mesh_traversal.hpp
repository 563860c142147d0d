// Walking down two bounding hierarchies side by side.
#pragma once

#include <array>
#include <cstdint>

#include "geometry/shape/mesh_pair.hpp"
#include "geometry/shape/separation.hpp"

namespace octopair {

inline PosedBoxes boxes_of(const PosedMesh& mesh) { return {mesh.pose, mesh.tree.origin, mesh.tree.nodes[0]}; }

/// A node of each tree.
struct NodePair {
    std::uint32_t a, b;
};

/// The larger of two nodes gives way to its children. Neither may be a leaf beside a leaf.
inline std::array<NodePair, 2> children_of(const NodePair& at, const PosedMesh& a, const PosedMesh& b,
                                           const Separation& separation) {
    const MeshNode &node_a = a.tree.nodes[at.a], &node_b = b.tree.nodes[at.b];
    if (!node_a.is_leaf() && (node_b.is_leaf() || separation.first_is_larger(node_a, node_b))) {
        return {{{node_a.first, at.b}, {node_a.first + 1, at.b}}};
    }
    return {{{at.a, node_b.first}, {at.a, node_b.first + 1}}};
}

/// Nodes yet to be looked at. Each step down puts at most one more aside, so the depths of both trees bound them.
template <typename Element>
class NodeStack {
public:
    void push(const Element& element) { elements_[count_++] = element; }
    Element pop() { return elements_[--count_]; }
    bool empty() const { return count_ == 0; }

private:
    std::array<Element, 2 * MeshTree::most_depth + 2> elements_;
    std::uint32_t count_ = 0;
};

/// Calls leaves(node of a, node of b) for leaves that may be no further apart than `reach`, until it returns false.
template <typename Leaves>
void visit_leaves(const PosedMesh& a, const PosedMesh& b, double reach, const Leaves& leaves) {
    if (a.tree.nodes.empty() || b.tree.nodes.empty()) return;
    const Separation separation(boxes_of(a), boxes_of(b));
    NodeStack<NodePair> waiting;
    waiting.push({0, 0});
    while (!waiting.empty()) {
        const NodePair at = waiting.pop();
        const MeshNode &node_a = a.tree.nodes[at.a], &node_b = b.tree.nodes[at.b];
        if (separation.apart(node_a, node_b, reach)) continue;
        if (node_a.is_leaf() && node_b.is_leaf()) {
            if (!leaves(node_a, node_b)) return;
            continue;
        }
        const auto children = children_of(at, a, b, separation);
        waiting.push(children[1]);
        waiting.push(children[0]);
    }
}

/// The triangles of a leaf, in the world, with their boxes.
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
