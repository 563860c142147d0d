// Directory: the octants of a linear octree in pre-order, and the way from cells to them.
//
// Invariants
//   nodes()[0] is the root; a node's subtree is nodes [i, node.next), its children (all eight or none) in digit order.
//   The leaves tile the whole frame, so every cell lies in exactly one leaf.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/test_hooks.hpp"
#include "octree/build/octant_growth.hpp"
#include "octree/frame.hpp"

namespace octopair {

/// A position in Directory::nodes().
using NodeIndex = std::uint32_t;

struct Node {
    Cell lo;                 ///< its first cell on each axis
    unsigned level;          ///< its side is 2^(21 - level) cells
    NodeIndex parent;        ///< the root is its own
    NodeIndex next;          ///< the first node after its subtree
    std::uint32_t children;  ///< row of the child table; no_children for a leaf

    static constexpr std::uint32_t no_children = ~std::uint32_t(0);
    bool leaf() const { return children == no_children; }
    OctalCode code() const { return OctalCode::from_cell({lo[0], lo[1], lo[2]}, level); }

    bool touches(const CellBox& box) const {
        bool touched = true;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const std::uint32_t last = lo[axis] + ((cells_per_axis >> level) - 1);
            touched &= box.lo[axis] <= last && box.hi[axis] >= lo[axis] + (planted(Fault::octant_border_open) ? 1 : 0);
        }
        return touched;
    }
    /// The axes, as class bits (entry.hpp), on which a box begins before this octant.
    std::uint32_t begins_before(const CellBox& box) const {
        std::uint32_t axes = 0;
        for (unsigned axis = 0; axis < 3; ++axis) axes |= std::uint32_t(box.lo[axis] < lo[axis]) << axis;
        return axes;
    }
};

class Directory {
public:
    /// The root alone.
    Directory() : Directory({}, {0}) {}
    /// The shape is that of the root. Throws Error{resource_limit} for more than 2^26 octants.
    Directory(const Frame& frame, const OctantShape& shape);

    std::span<const Node> nodes() const { return nodes_; }
    NodeIndex child(const Node& node, unsigned digit) const { return children_[node.children][digit]; }

    /// A leaf and its level.
    class Leaf {
    public:
        Leaf() = default;
        NodeIndex node() const { return element_ & most_nodes; }
        unsigned level() const { return element_ >> node_bits; }

    private:
        friend Directory;
        explicit Leaf(std::uint32_t element) : element_(element) {}
        std::uint32_t element_;
    };
    /// The leaf that holds the cell.
    Leaf leaf(const Cell& cell) const {
        unsigned shift = table_shift_;
        std::uint32_t found = first_element(cell);
        while (found >= further) found = further_element(found, cell, shift);
        return Leaf(found);
    }
    /// Of many at once: the leaf that each box begins in.
    void leaves(std::span<const CellBox> boxes, std::span<Leaf> leaves) const;
    /// The leaf itself, or the octant of `level` that holds it.
    NodeIndex at_most(const Leaf& leaf, unsigned level) const {
        NodeIndex node = leaf.node();
        for (unsigned at = leaf.level(); at > level; --at) node = nodes_[node].parent;
        return node;
    }

private:
    NodeIndex append(const Octant& octant, NodeIndex parent, const OctantShape& shape);
    void make_table(const Frame& frame);
    struct Table;
    void fill_table(NodeIndex index, const Table& table);
    std::uint32_t add_table(NodeIndex index, const Table& table);

    std::vector<Node> nodes_;
    std::vector<std::array<NodeIndex, 8>> children_;

    // From cells to leaves: a table of one level's octants, row-major, and for octants that are divided further tables
    // of the next three levels, and so on. An element is a leaf and its level, or where the further table begins.
    static constexpr unsigned table_levels = 3;
    static constexpr unsigned node_bits = 26;
    static constexpr std::uint32_t most_nodes = (std::uint32_t(1) << node_bits) - 1;
    static constexpr std::uint32_t further = (deepest + 1) << node_bits;
    std::uint32_t first_element(const Cell& cell) const {
        const std::uint32_t x = cell[0] >> table_shift_, y = cell[1] >> table_shift_, z = cell[2] >> table_shift_;
        return table_[(z * table_size_[1] + y) * table_size_[0] + x];
    }
    /// In the table that `element` tells, whose octants have 2^shift cells an axis afterwards.
    std::uint32_t further_element(std::uint32_t element, const Cell& cell, unsigned& shift) const {
        const unsigned bits = std::min(shift, table_levels);
        const unsigned mask = (1u << bits) - 1;
        shift -= bits;
        const std::uint32_t x = cell[0] >> shift & mask, y = cell[1] >> shift & mask, z = cell[2] >> shift & mask;
        return table_[element - further + ((z << table_levels | y) << table_levels | x)];
    }
    std::vector<std::uint32_t> table_;
    std::array<std::uint32_t, 3> table_size_ = {1, 1, 1};
    unsigned table_shift_ = deepest;
};

}  // namespace octopair
