// Tests the sort of short rows: its networks, its SIMD kernel against the scalar specification, and rows of all lengths.
#include "boxes/slotted_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "boxes/sorting_networks.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

/// A network sorts all numbers if it sorts all sequences of zeros and ones (Knuth, The Art of Computer Programming 3, section 5.3.4).
template <std::size_t count>
void expect_sorts() {
    for (std::uint32_t sequence = 0; sequence < 1u << count; ++sequence) {
        std::uint32_t sorted = sequence;
        for (const auto& [low, high] : sorting_network<count>) {
            const bool exchanged = (sorted >> low & 1u) > (sorted >> high & 1u);
            if (exchanged) sorted ^= 1u << low | 1u << high;
        }
        const std::uint32_t zeros = std::uint32_t(std::countr_zero(sorted | 1u << count));
        ASSERT_EQ(sorted, (1u << count) - (1u << zeros)) << count << " numbers, sequence " << sequence;
    }
}

TEST(SortingNetworks, SortAllSequencesOfZerosAndOnes) {
    expect_sorts<4>();
    expect_sorts<8>();
    expect_sorts<16>();
}

TEST(SlottedRows, KernelAndSpecificationAgree) {
    std::mt19937 random(1);
    for (int round = 0; round < 2000; ++round) {
        alignas(64) std::array<std::uint32_t, row_group * row_slots> slots;
        std::array<std::uint16_t, row_group> counts;
        const std::uint32_t most = std::uint32_t(random() % 20);  // more than row_slots: some rows are long
        const std::uint32_t objects = random() % 2 == 0 ? 10 : ~0u;
        for (std::uint32_t& slot : slots) slot = std::uint32_t(random()) % objects;
        for (std::uint16_t& count : counts) count = std::uint16_t(random() % (most + 1));
        const RowGroup group{slots.data(), counts.data(), std::uint32_t(random())};
        std::size_t pairs = 0;
        for (const std::uint16_t count : counts) pairs += count <= row_slots ? count : 0;
        std::vector<Pair> found(pairs + row_slots), expected(pairs + row_slots);
        sort_group(group, found.data());
        sort_group_scalar(group, expected.data());
        found.resize(pairs);
        expected.resize(pairs);
        ASSERT_TRUE(same_sequence(found, expected)) << "round " << round;
    }
}

/// Returns the pairs of all rows in ascending order.
std::vector<Pair> sorted_pairs(const SlottedRows& rows) {
    std::vector<Pair> sorted;
    std::array<Pair, row_slots*(row_group + 1)> some;
    for (std::size_t first = 0; first < rows.rows(); first += row_group) {
        sort_group(rows.group(first), some.data());
        const Pair* at = some.data();
        for (std::size_t row = first; row < std::min(first + row_group, rows.rows()); ++row) {
            if (!rows.is_long(row)) {
                sorted.insert(sorted.end(), at, at + rows.size(row));
                at += rows.size(row);
                continue;
            }
            std::vector<std::uint32_t> columns(rows.long_row(row).begin(), rows.long_row(row).end());
            std::ranges::sort(columns);
            for (const std::uint32_t second : columns) sorted.push_back({rows.object(row), second});
        }
    }
    return sorted;
}

TEST(SlottedRows, HaveThePairsOfAllRows) {
    std::mt19937 random(2);
    SlottedRows slotted;  // as in a bucket sort, used for one bucket after another
    for (int round = 0; round < 300; ++round) {
        const std::size_t rows = std::size_t(1) << random() % 8;
        const auto first_object = std::uint32_t(random() % 2 == 0 ? random() % 1000 : 0u - std::uint32_t(rows));
        std::vector<Pair> pairs(random() % 2000);
        const std::size_t crowded = random() % rows;
        for (Pair& pair : pairs) {
            const std::size_t row = random() % 3 == 0 ? crowded : random() % rows;
            pair = {first_object + std::uint32_t(row), std::uint32_t(random() % 5000)};
        }
        slotted.reset(rows, pairs.size(), first_object);
        const std::span<const Pair> all = pairs;
        const std::size_t page = 1 + random() % 600;
        for (std::size_t begin = 0; begin < pairs.size(); begin += page) {
            const auto rest = all.subspan(begin), next = rest.subspan(std::min(page, rest.size()));
            slotted.add(rest.first(std::min(page, rest.size())), next.first(std::min(page, next.size())));
        }
        slotted.collect_long_rows();
        std::ranges::sort(pairs, {}, [](const Pair& pair) { return std::pair(pair.a, pair.b); });
        ASSERT_TRUE(same_sequence(sorted_pairs(slotted), pairs)) << "round " << round;
    }
}

}  // namespace
}  // namespace octopair::test
