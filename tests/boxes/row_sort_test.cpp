// Tests the kernel that sorts rows of pairs against its specification.
#include "boxes/row_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "support/compare.hpp"

namespace octopair::test {
namespace {

TEST(SortRows, KernelAndSpecificationAgree) {
    std::mt19937 random(1);
    for (int round = 0; round < 300; ++round) {
        std::vector<std::uint32_t> seconds, ends;
        const std::uint32_t begin = std::uint32_t(random() % 3);
        seconds.resize(begin);
        for (std::size_t rows = random() % 40; rows > 0; --rows) {
            const std::size_t size = random() % (random() % 4 == 0 ? max_row_at_once + 1 : 5);
            std::vector<std::uint32_t> row;
            while (row.size() < size) {
                // Small numbers, and numbers around the sign bit and the greatest number.
                const std::uint32_t bases[] = {0, 0x7FFFFFF0, 0xFFFFFFC0};
                const std::uint32_t object = bases[random() % 3] + std::uint32_t(random() % 64);
                const bool doubled_round = round % 4 == 0;
                if (doubled_round || std::ranges::find(row, object) == row.end()) row.push_back(object);
            }
            seconds.insert(seconds.end(), row.begin(), row.end());
            ends.push_back(std::uint32_t(seconds.size()));
        }
        const std::size_t pairs = seconds.size() - begin;
        seconds.resize(seconds.size() + 16);
        std::vector<Pair> found(pairs), expected(pairs);
        sort_rows({seconds.data(), begin, ends, 1000}, found.data());
        sort_rows_scalar({seconds.data(), begin, ends, 1000}, expected.data());
        ASSERT_TRUE(same_sequence(found, expected)) << "round " << round;
        ASSERT_TRUE(std::ranges::is_sorted(
            found, [](const Pair& a, const Pair& b) { return a.a != b.a ? a.a < b.a : a.b < b.b; }));
    }
}

}  // namespace
}  // namespace octopair::test
