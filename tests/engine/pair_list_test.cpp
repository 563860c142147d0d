// Tests PairStorage: the sizes of the blocks that a list takes.
#include "engine/pair_list.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/tuning.hpp"

namespace octopair::test {
namespace {

constexpr std::size_t huge_page = (std::size_t(2) << 20) / sizeof(Pair);

/// Takes blocks until they have `pairs` pairs. Returns the size of the next block.
std::size_t next_block_after(detail::PairStorage& list, std::size_t pairs) {
    for (std::size_t taken = 0; taken < pairs;) taken += list.take_block(1).size();
    return list.take_block(1).size();
}

TEST(PairStorage, GrowsByAQuarterInHugePages) {
    detail::PairStorage list;
    EXPECT_EQ(next_block_after(list, 3 * huge_page), tuning().output.list_block);
    EXPECT_EQ(next_block_after(list, 9 * huge_page), 3 * huge_page);  // of 12 and a part
    EXPECT_EQ(next_block_after(list, 100 * huge_page), 16 * huge_page);
}

TEST(PairStorage, TakesTheSmallestBlocksWhenEachNeedsPermission) {
    detail::PairStorage list;
    std::vector<std::uint64_t> asked;
    list.ask([&](std::uint64_t bytes) { asked.push_back(bytes); });
    EXPECT_EQ(next_block_after(list, 20 * huge_page), tuning().output.list_block);
    EXPECT_EQ(asked.back(), tuning().output.list_block * sizeof(Pair));
}

TEST(PairStorage, ReusesItsBlocksAfterAReset) {
    detail::PairStorage list;
    (void)next_block_after(list, 20 * huge_page);
    list.reset();
    std::size_t asked = 0;
    list.ask([&](std::uint64_t) { ++asked; });
    (void)next_block_after(list, 19 * huge_page);
    EXPECT_EQ(asked, 0u);
}

}  // namespace
}  // namespace octopair::test
