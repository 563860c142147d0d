#include "octree/directory.hpp"

#include <algorithm>
#include <bit>

#include "base/stop.hpp"

namespace octopair {

namespace {

// Found by measurement on the scenes of docs/scenes.md; they change the shape of the tree, never the set of pairs.
constexpr double always_split = 2048;      // objects: more would not stay in the cache while they are swept
constexpr double never_split = 512;        // objects
constexpr double crowded_window = 40;      // objects that a sweep tests for each object
constexpr double ghost_growth = 1.6;       // entries below a node for each object that begins in it
constexpr double handed_growth = 1.5;      // entries and boxes handed down, after a split against before
constexpr std::uint64_t cells_a_node = 4;  // of the table from cells to leaves

/// The octant `digit` of `node`, as a leaf.
Node child_octant(const Node& node, NodeIndex parent, unsigned digit) {
    Node octant{node.lo, node.level + 1, parent, 0, Node::no_children};
    const std::uint32_t side = cells_per_axis >> octant.level;
    for (unsigned axis = 0; axis < 3; ++axis) octant.lo[axis] += (digit >> axis & 1u) * side;
    return octant;
}

}  // namespace

/// What all nodes are grown by.
struct Directory::Growth {
    double weight;
    std::stop_token stop;

    bool crowded(const Node& node, const Boxes& inside) const;
};

bool Directory::Growth::crowded(const Node& node, const Boxes& inside) const {
    const double objects = double(inside.size()) * weight;
    if (objects <= never_split) return false;
    if (objects > always_split) return true;
    double window = objects;
    for (unsigned axis = 0; axis < 3; ++axis) {
        std::uint32_t first = cells_per_axis;
        std::uint32_t last = 0;
        std::uint64_t extents = 0;
        const std::uint32_t end = node.lo[axis] + ((cells_per_axis >> node.level) - 1);
        for (const CellBox& box : inside) {
            const std::uint32_t lo = std::max(box.lo[axis], node.lo[axis]);
            first = std::min(first, lo);
            last = std::max(last, lo);
            extents += std::min(box.hi[axis], end) - lo + 1;
        }
        const double extent = double(extents) / double(inside.size());
        window = std::min(window, objects * extent / (double(last - first) + extent));
    }
    return window > crowded_window;
}

namespace {

/// The boxes, all of which touch `node`, by the children that they touch; returns how many entries that makes.
std::size_t divide(const Node& node, const Directory::Boxes& boxes, std::array<Directory::Boxes, 8>& children) {
    // Per axis the children, as bits, of the lower and of the upper half.
    constexpr std::array<std::array<unsigned, 2>, 3> halves = {{{0x55, 0xAA}, {0x33, 0xCC}, {0x0F, 0xF0}}};
    const std::uint32_t half = (cells_per_axis >> node.level) / 2;
    for (Directory::Boxes& child : children) child.reserve(boxes.size() / 6);
    std::size_t entries = 0;
    for (const CellBox& box : boxes) {
        unsigned touched = 0xFF;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const std::uint32_t middle = node.lo[axis] + half;
            const unsigned lower = box.lo[axis] < middle ? halves[axis][0] : 0;
            const unsigned upper = box.hi[axis] >= middle ? halves[axis][1] : 0;
            touched &= lower | upper;
        }
        entries += std::size_t(std::popcount(touched));
        for (; touched != 0; touched &= touched - 1) children[unsigned(std::countr_zero(touched))].push_back(box);
    }
    return entries;
}

std::size_t beginning_in(const Node& node, const Directory::Boxes& boxes) {
    return std::size_t(std::count_if(boxes.begin(), boxes.end(), [&](const CellBox& box) {
        return box.lo[0] >= node.lo[0] && box.lo[1] >= node.lo[1] && box.lo[2] >= node.lo[2];
    }));
}

}  // namespace

Directory::Directory(const Frame& frame, Boxes sample, double weight, std::stop_token stop) {
    const Growth growth{weight, stop};
    const Node root{.lo = {}, .level = 0, .parent = 0, .next = 0, .children = Node::no_children};
    grow(growth, root, std::move(sample), {});
    make_table(frame);
}

/// Appends `start` and its subtree. `sample`: what touches the octant and is not too large for its level; `handed`:
/// what touches it and is kept above.
NodeIndex Directory::grow(const Growth& growth, const Node& start, Boxes sample, Boxes handed) {
    throw_if_stopped(growth.stop);
    const NodeIndex index = NodeIndex(nodes_.size());
    nodes_.push_back(start);
    const auto kept = std::stable_partition(sample.begin(), sample.end(),
                                            [&](const CellBox& box) { return natural_level(box) > start.level; });
    handed.insert(handed.end(), kept, sample.end());
    sample.erase(kept, sample.end());
    std::array<Boxes, 8> inside_child, handed_child;
    const bool room = nodes_.size() + 8 * (deepest + 1) < most_nodes;  // for the siblings to come, too
    bool split = room && start.level < deepest && growth.crowded(start, sample);
    if (split) {
        const std::size_t entries = divide(start, sample, inside_child);
        const std::size_t copies = divide(start, handed, handed_child);
        split = double(entries) <= ghost_growth * double(beginning_in(start, sample)) &&
                double(entries + copies) <= handed_growth * double(sample.size() + handed.size());
    }
    sample = {};
    handed = {};
    if (split) {
        const std::uint32_t row = std::uint32_t(children_.size());
        nodes_[index].children = row;
        children_.emplace_back();
        for (unsigned digit = 0; digit < 8; ++digit) {
            const Node octant = child_octant(start, index, digit);
            const NodeIndex child =
                grow(growth, octant, std::move(inside_child[digit]), std::move(handed_child[digit]));
            children_[row][digit] = child;
        }
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
