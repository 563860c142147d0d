// MeshWalk: simultaneous traversal of two bounding hierarchies, which finds the pairs of leaves within a given distance.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/mesh/separation.hpp"

namespace octopair {

inline PosedBoxes boxes_of(const PosedMesh& mesh) { return {mesh.pose, mesh.tree.origin, mesh.tree.nodes[0]}; }

/// One node of each tree.
struct NodePair {
    std::uint32_t a, b;
};

/// Stack of nodes that are still to be visited. Each step down adds at most one element, so the depths of both trees bound its
/// size.
template <typename Element>
class NodeStack {
public:
    void push(const Element& element) { elements_[count_++] = element; }
    /// Pushes only if `really` is true, without a branch.
    void push_if(const Element& element, bool really) {
        elements_[count_] = element;
        count_ += really;
    }
    Element pop() { return elements_[--count_]; }
    bool empty() const { return count_ == 0; }

private:
    std::array<Element, 2 * MeshTree::max_depth + 4> elements_;
    std::uint32_t count_ = 0;
};

/// Returns two pairs in which the larger node is replaced by its children. Requires: at most one node is a leaf.
inline std::array<NodePair, 2> children_of(const NodePair& at, const MeshNode& node_a, const MeshNode& node_b,
                                           const Separation& separation) {
    if (!node_a.is_leaf() && (node_b.is_leaf() || separation.first_is_larger(node_a, node_b))) {
        return {{{node_a.first, at.b}, {node_a.first + 1, at.b}}};
    }
    return {{{at.a, node_b.first}, {at.a, node_b.first + 1}}};
}

/// State of a traversal. Borrows the trees.
struct MeshWalk {
    /// Requires: both trees have nodes.
    MeshWalk(const PosedMesh& a, const PosedMesh& b, float most)
        : nodes_a(a.tree.nodes), nodes_b(b.tree.nodes), separation(boxes_of(a), boxes_of(b)), reach(most) {
        waiting.push_if({0, 0}, !separation.apart(nodes_a[0], nodes_b[0], reach));
    }

    std::span<const MeshNode> nodes_a, nodes_b;
    Separation separation;
    float reach;
    NodeStack<NodePair> waiting;  // pairs whose boxes were within reach when they were pushed
};

/// Writes the next pairs of leaves within reach to `leaves` and returns their number. The number is below `leaves.size()` only
/// at the end of the traversal. The order depends only on the trees and poses.
unsigned next_leaves(MeshWalk& walk, std::span<NodePair> leaves);

}  // namespace octopair
