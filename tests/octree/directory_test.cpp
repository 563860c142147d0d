// Tests Directory: octants computed from split flags, and the leaf of each cell.
#include "octree/plan/directory.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "octopair/error.hpp"

namespace octopair::test {
namespace {

/// Appends the flags of a random subtree whose leaves are at most `depth` levels below its root.
void append_random_splits(std::mt19937& random, unsigned depth, SplitFlags& splits) {
    const bool is_split = depth > 0 && random() % 3 == 0;
    splits.push_back(is_split ? 1 : 0);
    for (unsigned digit = 0; is_split && digit < 8; ++digit) append_random_splits(random, depth - 1, splits);
}

/// Returns the flags of a tree that is split only along the path to the root's first cell, down to the deepest level.
SplitFlags deepest_corner() {
    SplitFlags splits;
    for (unsigned level = 0; level < deepest; ++level) splits.push_back(1);
    splits.push_back(0);                                             // the deepest octant
    for (unsigned i = 0; i < 7 * deepest; ++i) splits.push_back(0);  // its siblings, and those of its ancestors
    return splits;
}

Space unit_space() {
    const std::vector<Entry> sample = {{{0, 0, 0}, {0.001f, 0.001f, 0.001f}, 0, 0}, {{1, 1, 1}, {1, 1, 1}, 1, 0}};
    return Space::fit(sample, 2);
}

Cell random_cell(std::mt19937& random, const Space& space) {
    Cell cell{};
    for (unsigned axis = 0; axis < 3; ++axis) cell[axis] = std::uint32_t(random()) % (space.last_cell(axis) + 1);
    return cell;
}

/// Descends from the root: the specification of Directory::leaf.
OctantIndex leaf_by_descent(const Directory& directory, const Cell& cell) {
    OctantIndex at = 0;
    while (!directory.octants()[at].leaf()) {
        const Octant& octant = directory.octants()[at];
        const unsigned shift = deepest - octant.level - 1;
        unsigned digit = 0;
        for (unsigned axis = 0; axis < 3; ++axis) digit |= (cell[axis] >> shift & 1u) << axis;
        at = directory.child(octant, digit);
    }
    return at;
}

void expect_leaves_by_descent(const Directory& directory, const Space& space, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<CellBox> boxes(257);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        boxes[i].lo = boxes[i].hi = i == 0 ? Cell{} : random_cell(random, space);
        const Directory::Leaf leaf = directory.leaf(boxes[i].lo);
        ASSERT_EQ(leaf.octant(), leaf_by_descent(directory, boxes[i].lo));
        ASSERT_EQ(leaf.level(), directory.octants()[leaf.octant()].level);
    }
    std::vector<Directory::Leaf> leaves(boxes.size());
    directory.leaves(boxes, leaves);
    for (std::size_t i = 0; i < boxes.size(); ++i) ASSERT_EQ(leaves[i].octant(), directory.leaf(boxes[i].lo).octant());
}

TEST(Directory, TheRootAloneHoldsEveryCell) {
    const Directory directory;
    ASSERT_EQ(directory.octants().size(), 1u);
    EXPECT_TRUE(directory.octants()[0].leaf());
    EXPECT_EQ(directory.leaf(Cell{cells_per_axis - 1, 0, 5, 0}).octant(), 0u);
}

TEST(Directory, FindsTheLeafThatADescentFinds) {
    const Space space = unit_space();
    for (unsigned seed = 0; seed < 50; ++seed) {
        std::mt19937 random(seed);
        SplitFlags splits;
        append_random_splits(random, 7, splits);
        expect_leaves_by_descent(Directory(space, splits), space, seed);
    }
}

TEST(Directory, ReachesTheDeepestLevel) {
    const Space space = unit_space();
    const Directory directory(space, deepest_corner());
    EXPECT_EQ(directory.leaf(Cell{}).level(), deepest);
    expect_leaves_by_descent(directory, space, 1);
    // The ancestors of a leaf, by level.
    for (unsigned level = 0; level <= deepest; ++level) {
        EXPECT_EQ(directory.octants()[directory.at_most(directory.leaf(Cell{}), level)].level, level);
    }
}

TEST(Directory, AnOctantTouchesABoxThatReachesItsFirstOrLastCell) {
    const Directory directory(unit_space(), deepest_corner());
    const Octant& octant =
        directory.octants()[directory.child(directory.octants()[0], 7)];  // the upper half of each axis
    const std::uint32_t half = cells_per_axis / 2;
    EXPECT_TRUE(octant.touches({{0, 0, 0, 0}, {half, half, half, 0}}));
    EXPECT_FALSE(octant.touches({{0, 0, 0, 0}, {half, half, half - 1, 0}}));
    EXPECT_EQ(class_bits(CellBox{{half, half - 1, half, 0}, {half, half, half, 0}}, octant), 2u);
}

}  // namespace
}  // namespace octopair::test
