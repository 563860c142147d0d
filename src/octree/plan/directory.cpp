#include "octree/plan/directory.hpp"

#include <algorithm>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octopair/error.hpp"

namespace octopair {

OctantCube OctantCube::child(unsigned digit) const {
    OctantCube below{lo, level + 1};
    const std::uint32_t side = cells_per_axis >> below.level;
    for (unsigned axis = 0; axis < 3; ++axis) below.lo[axis] += (digit >> axis & 1u) * side;
    return below;
}

Directory::Directory(const Space& space, const SplitFlags& shape) {
    if (shape.size() >= max_octants) throw Error(ErrorCode::resource_limit, "octree: needs 2^26 - 1 octants or more");
    octants_.reserve(shape.size());
    append({}, 0, shape);
    make_table(space);
}

/// Appends the next octant of the shape and its subtree. Returns the octant's index.
OctantIndex Directory::append(const OctantCube& cube, OctantIndex parent, const SplitFlags& shape) {
    const OctantIndex index = OctantIndex(octants_.size());
    octants_.push_back({cube.lo, cube.level, parent, index + 1, Octant::no_children});
    if (shape[index] == 0) return index;
    const std::uint32_t row = std::uint32_t(children_.size());
    octants_[index].children = row;
    children_.emplace_back();
    for (unsigned digit = 0; digit < 8; ++digit) {
        const OctantIndex child = append(cube.child(digit), index, shape);
        children_[row][digit] = child;
    }
    octants_[index].next = OctantIndex(octants_.size());
    return index;
}

void Directory::leaves(std::span<const CellBox> boxes, std::span<Leaf> leaves) const {
    // All boxes go through one level of tables before any goes to the next. So the lookups of different boxes overlap, and no
    // branch on the depth of a box's leaf is mispredicted.
    std::array<std::uint32_t, 256> waiting;
    for (std::size_t begin = 0; begin < boxes.size(); begin += waiting.size()) {
        const auto some = boxes.subspan(begin, std::min(waiting.size(), boxes.size() - begin));
        Leaf* const out = leaves.data() + begin;
        std::size_t count = 0;
        for (std::uint32_t i = 0; i < some.size(); ++i) {
            out[i] = Leaf(first_element(some[i].lo));
            waiting[count] = i;
            count += out[i].element() >= further ? 1 : 0;
        }
        for (unsigned shift = table_shift_; count > 0;) {
            unsigned below = shift;
            std::size_t left = 0;
            for (const std::uint32_t i : std::span(waiting).first(count)) {
                below = shift;
                out[i] = Leaf(further_element(out[i].element(), some[i].lo, below));
                waiting[left] = i;
                left += out[i].element() >= further ? 1 : 0;
            }
            shift = below;
            count = left;
        }
    }
}

/// A table of octants of one level, which starts at cell `first` of the space and at element `begin` of table_.
struct Directory::Table {
    Cell first;
    std::array<std::uint32_t, 3> sizes;
    unsigned level;
    std::size_t begin;
};

void Directory::make_table(const Space& space) {
    unsigned depth = 0;
    for (const Octant& octant : octants_) depth = std::max(depth, octant.level);
    const auto rows = [&](unsigned level, unsigned axis) { return (space.last_cell(axis) >> (deepest - level)) + 1; };
    const std::uint64_t max_cells = tuning().split.max_cells_per_octant * octants_.size();
    unsigned level = 0;
    while (level < depth && std::uint64_t(rows(level + 1, 0)) * rows(level + 1, 1) * rows(level + 1, 2) <= max_cells) {
        ++level;
    }
    table_size_ = {rows(level, 0), rows(level, 1), rows(level, 2)};
    table_shift_ = deepest - level;
    last_shift_ = deepest - depth;
    table_.resize(std::size_t(table_size_[0]) * table_size_[1] * table_size_[2]);
    fill_table(0, {{}, table_size_, level, 0});
}

/// Sets the elements of `table` whose cells lie in octant `index`. Ignores the part of the octant outside the table.
void Directory::fill_table(OctantIndex index, const Table& table) {
    const Octant octant = octants_[index];
    if (!octant.leaf() && octant.level < table.level) {
        for (const OctantIndex child : children_[octant.children]) fill_table(child, table);
        return;
    }
    const unsigned shift = deepest - table.level;
    std::array<std::uint32_t, 3> begin, end;
    for (unsigned axis = 0; axis < 3; ++axis) {
        begin[axis] = std::min((octant.lo[axis] - table.first[axis]) >> shift, table.sizes[axis]);
        end[axis] = std::min(begin[axis] + (1u << (table.level - octant.level)), table.sizes[axis]);
        if (begin[axis] == end[axis]) return;
    }
    const std::uint32_t element = octant.leaf() ? index | octant.level << octant_bits : add_table(index, table);
    for (std::uint32_t z = begin[2]; z < end[2]; ++z) {
        for (std::uint32_t y = begin[1]; y < end[1]; ++y) {
            const std::size_t row = table.begin + (std::size_t(z) * table.sizes[1] + y) * table.sizes[0];
            std::fill(table_.begin() + std::ptrdiff_t(row + begin[0]), table_.begin() + std::ptrdiff_t(row + end[0]),
                      element);
        }
    }
}

/// Adds a table for the levels below an octant of `table`. Returns the element that refers to the new table.
std::uint32_t Directory::add_table(OctantIndex index, const Table& table) {
    count_path(Path::table_further);
    const std::size_t begin = table_.size();
    const unsigned levels = leaf_table().levels_below(deepest - table.level);
    table_.resize(begin + (std::size_t(1) << 3 * levels));
    const std::uint32_t side = 1u << levels;
    const unsigned level = table.level + levels;
    for (const OctantIndex child : children_[octants_[index].children]) {
        fill_table(child, {octants_[index].lo, {side, side, side}, level, begin});
    }
    return further + std::uint32_t(begin);
}

}  // namespace octopair
