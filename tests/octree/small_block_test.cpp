// Tests the kernel that searches a block against its specification, and the conversion of boxes to the numbers of a
// unit.
#include "octree/dynamic/small_block.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "octree/dynamic/leaf_grid.hpp"

namespace octopair::test {
namespace {

SmallBox random_box(std::mt19937& random, std::uint32_t numbers) {
    SmallBox box;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const std::uint32_t a = std::uint32_t(random()) % numbers, b = std::uint32_t(random()) % numbers;
        box.set(axis, std::min(a, b), std::max({a, b, 1u}));
    }
    return box;
}

TEST(SmallBlock, KernelFindsWhatTheSpecificationDoes) {
    std::mt19937 random(1);
    std::size_t found = 0;
    for (int round = 0; round < 20000; ++round) {
        // With few numbers, many boxes touch or begin before the unit.
        const std::uint32_t numbers = round % 2 == 0 ? 4 : 256;
        SmallBlock block{};
        block.count = std::uint32_t(random()) % (SmallBlock::capacity + 1);
        for (std::size_t i = 0; i < SmallBlock::capacity; ++i) {
            block.set(i, random_box(random, numbers), std::uint32_t(random()));
        }
        const SmallBox wanted = random_box(random, numbers);
        std::uint32_t expected = 0;
        for (std::size_t i = 0; i < block.count; ++i) {
            expected |= std::uint32_t(overlap(block.box(i), wanted)) << i;
            found += overlap(block.box(i), wanted) ? 1 : 0;
        }
        ASSERT_EQ(overlapping(block, wanted), expected);
    }
    EXPECT_GT(found, 1000u);
}

/// Tests units of all sizes: boxes that overlap in cells overlap in the unit's numbers, and the cells of the numbers
/// contain the box.
TEST(Unit, NumbersLoseNothing) {
    std::mt19937 random(2);
    for (int round = 0; round < 20000; ++round) {
        const unsigned level = std::uint32_t(random()) % (deepest + 1);
        const std::uint32_t side = cells_per_axis >> level, octants = 1u << level;
        Octant octant{};
        octant.level = level;
        octant.children = Octant::no_children;
        for (unsigned axis = 0; axis < 3; ++axis) octant.lo[axis] = std::uint32_t(random()) % octants * side;
        const Unit unit = LeafGrid::cut(octant, 0, {}).own_unit();
        const auto random_cells = [&] {
            CellBox box;
            for (unsigned axis = 0; axis < 3; ++axis) {
                // Near the unit, so that boxes touch the unit, its borders and each other.
                const std::int64_t first = std::int64_t(octant.lo[axis]) - side,
                                   last = std::int64_t(octant.lo[axis]) + 2 * side;
                std::int64_t a = std::uniform_int_distribution<std::int64_t>(first, last)(random);
                std::int64_t b = std::uniform_int_distribution<std::int64_t>(first, last)(random);
                if (a > b) std::swap(a, b);
                a = std::clamp<std::int64_t>(a, 0, octant.lo[axis] + side - 1);
                b = std::clamp<std::int64_t>(b, octant.lo[axis], cells_per_axis - 1);
                box.lo[axis] = std::uint32_t(std::min(a, b));
                box.hi[axis] = std::uint32_t(std::max(a, b));
            }
            return box;
        };
        const CellBox a = random_cells(), b = random_cells();
        bool begins_here = true, overlaps = true;
        for (unsigned axis = 0; axis < 3; ++axis) {
            begins_here &= std::max(a.lo[axis], b.lo[axis]) >= octant.lo[axis];
            overlaps &= a.lo[axis] <= b.hi[axis] && b.lo[axis] <= a.hi[axis];
        }
        if (overlaps && begins_here) {
            ASSERT_TRUE(overlap(unit.small(a), unit.small(b))) << "level " << level;
        }
        SmallBox inside = unit.small(b);
        inside.begin_inside();
        const bool meet_in_unit = overlaps && std::min(a.hi[0], b.hi[0]) >= octant.lo[0] &&
                                  std::min(a.hi[1], b.hi[1]) >= octant.lo[1] &&
                                  std::min(a.hi[2], b.hi[2]) >= octant.lo[2];
        if (meet_in_unit) {
            ASSERT_TRUE(overlap(unit.small(a), inside)) << "level " << level;
        }
        const CellRegion held = unit.region(unit.small(a));
        for (unsigned axis = 0; axis < 3; ++axis) {
            ASSERT_LE(held.lo[axis], double(std::max(a.lo[axis], octant.lo[axis])) + 1);
            ASSERT_GE(held.hi[axis], double(std::min(a.hi[axis], octant.lo[axis] + side - 1)));
        }
    }
}

}  // namespace
}  // namespace octopair::test
