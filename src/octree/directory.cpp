#include "octree/directory.hpp"

#include <algorithm>

#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr std::uint64_t cells_a_node = 4;  // of the table from cells to leaves

}  // namespace

Directory::Directory(const Frame& frame, const OctantShape& shape) {
    if (shape.size() >= most_nodes) throw Error(ErrorCode::resource_limit, "more octants than can be numbered");
    nodes_.reserve(shape.size());
    append({}, 0, shape);
    make_table(frame);
}

/// The octant that comes next in the shape, and its subtree.
NodeIndex Directory::append(const Octant& octant, NodeIndex parent, const OctantShape& shape) {
    const NodeIndex index = NodeIndex(nodes_.size());
    nodes_.push_back({octant.lo, octant.level, parent, index + 1, Node::no_children});
    if (shape[index] == 0) return index;
    const std::uint32_t row = std::uint32_t(children_.size());
    nodes_[index].children = row;
    children_.emplace_back();
    for (unsigned digit = 0; digit < 8; ++digit) {
        const NodeIndex child = append(octant.child(digit), index, shape);
        children_[row][digit] = child;
    }
    nodes_[index].next = NodeIndex(nodes_.size());
    return index;
}

void Directory::leaves(std::span<const CellBox> boxes, std::span<Leaf> leaves) const {
    // One table after the other for all boxes, so that no box waits for another's and none is mispredicted.
    std::array<std::uint32_t, 256> waiting;
    for (std::size_t begin = 0; begin < boxes.size(); begin += waiting.size()) {
        const auto some = boxes.subspan(begin, std::min(waiting.size(), boxes.size() - begin));
        Leaf* const out = leaves.data() + begin;
        std::size_t count = 0;
        for (std::uint32_t i = 0; i < some.size(); ++i) {
            out[i] = Leaf(first_element(some[i].lo));
            waiting[count] = i;
            count += out[i].element_ >= further ? 1 : 0;
        }
        for (unsigned shift = table_shift_; count > 0;) {
            unsigned below = shift;
            std::size_t left = 0;
            for (const std::uint32_t i : std::span(waiting).first(count)) {
                below = shift;
                out[i] = Leaf(further_element(out[i].element_, some[i].lo, below));
                waiting[left] = i;
                left += out[i].element_ >= further ? 1 : 0;
            }
            shift = below;
            count = left;
        }
    }
}

/// A table of octants with 2^shift cells an axis, from `first` on; it begins at `begin` of table_.
struct Directory::Table {
    Cell first;
    std::array<std::uint32_t, 3> sizes;
    unsigned shift;
    std::size_t begin;
};

void Directory::make_table(const Frame& frame) {
    unsigned depth = 0;
    for (const Node& node : nodes_) depth = std::max(depth, node.level);
    const auto rows = [&](unsigned level, unsigned axis) { return (frame.last_cell(axis) >> (deepest - level)) + 1; };
    const std::uint64_t most_cells = cells_a_node * nodes_.size();
    unsigned level = 0;
    while (level < depth && std::uint64_t(rows(level + 1, 0)) * rows(level + 1, 1) * rows(level + 1, 2) <= most_cells) {
        ++level;
    }
    table_size_ = {rows(level, 0), rows(level, 1), rows(level, 2)};
    table_shift_ = deepest - level;
    table_.resize(std::size_t(table_size_[0]) * table_size_[1] * table_size_[2]);
    fill_table(0, {{}, table_size_, table_shift_, 0});
}

/// Fills a table all of which lies within the octant `from`, and further ones where needed.
void Directory::fill_table(NodeIndex from, const Table& table) {
    const unsigned level = deepest - table.shift;
    std::size_t at = table.begin;
    for (std::uint32_t z = 0; z < table.sizes[2]; ++z) {
        for (std::uint32_t y = 0; y < table.sizes[1]; ++y) {
            for (std::uint32_t x = 0; x < table.sizes[0]; ++x, ++at) {
                const Cell cell = {table.first[0] + (x << table.shift), table.first[1] + (y << table.shift),
                                   table.first[2] + (z << table.shift), 0};
                NodeIndex node = from;
                while (nodes_[node].level < level && !nodes_[node].leaf()) {
                    node = child(nodes_[node], digit_at(cell, nodes_[node].level));
                }
                if (nodes_[node].leaf()) {
                    table_[at] = node | nodes_[node].level << node_bits;
                    continue;
                }
                const std::size_t next = table_.size();
                table_.resize(next + (std::size_t(1) << 3 * table_levels));
                table_[at] = further + std::uint32_t(next);
                constexpr std::uint32_t side = 1u << table_levels;
                fill_table(node, {cell, {side, side, side}, table.shift - std::min(table.shift, table_levels), next});
            }
        }
    }
}

}  // namespace octopair
