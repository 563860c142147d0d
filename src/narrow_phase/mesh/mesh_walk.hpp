// Walking down two bounding hierarchies side by side, to the leaves that may be no further apart than some reach.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/mesh/separation.hpp"

namespace octopair {

inline PosedBoxes boxes_of(const PosedMesh& mesh) { return {mesh.pose, mesh.tree.origin, mesh.tree.nodes[0]}; }

/// A node of each tree.
struct NodePair {
    std::uint32_t a, b;
};

/// Nodes yet to be looked at. Each step down puts at most one more aside, so the depths of both trees bound them.
template <typename Element>
class NodeStack {
public:
    void push(const Element& element) { elements_[count_++] = element; }
    /// Room is taken only if `really`; no branch.
    void push_if(const Element& element, bool really) {
        elements_[count_] = element;
        count_ += really;
    }
    Element pop() { return elements_[--count_]; }
    bool empty() const { return count_ == 0; }

private:
    std::array<Element, 2 * MeshTree::most_depth + 4> elements_;
    std::uint32_t count_ = 0;
};

/// The larger of two nodes gives way to its children. Neither may be a leaf beside a leaf.
inline std::array<NodePair, 2> children_of(const NodePair& at, const MeshNode& node_a, const MeshNode& node_b,
                                           const Separation& separation) {
    if (!node_a.is_leaf() && (node_b.is_leaf() || separation.first_is_larger(node_a, node_b))) {
        return {{{node_a.first, at.b}, {node_a.first + 1, at.b}}};
    }
    return {{{at.a, node_b.first}, {at.a, node_b.first + 1}}};
}

/// A walk in progress. Trees must have nodes; they are borrowed.
struct MeshWalk {
    MeshWalk(const PosedMesh& a, const PosedMesh& b, float most)
        : nodes_a(a.tree.nodes), nodes_b(b.tree.nodes), separation(boxes_of(a), boxes_of(b)), reach(most) {
        waiting.push_if({0, 0}, !separation.apart(nodes_a[0], nodes_b[0], reach));
    }

    std::span<const MeshNode> nodes_a, nodes_b;
    Separation separation;
    float reach;
    NodeStack<NodePair> waiting;  // all of them within reach, as far as boxes tell
};

/// The next leaves, in an order that depends on the trees alone; how many. Less than there is room for, if no more are left.
unsigned next_leaves(MeshWalk& walk, std::span<NodePair> leaves);
/// The same, by Separation's own functions: the specification.
unsigned next_leaves_scalar(MeshWalk& walk, std::span<NodePair> leaves);

}  // namespace octopair
