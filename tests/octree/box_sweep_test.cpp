// Tests what is special to the sweep on boxes: the order of its hits, deep overlaps, and the order in which boxes start. sweep_test.cpp has
// the tests of both kinds of sweep.
#include "octree/sweep/box_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "octree/given_source.hpp"
#include "octree/sweep/start_order.hpp"
#include "octree/sweep_kinds.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

std::vector<Entry> random_boxes(std::mt19937& random, std::size_t count, std::uint32_t first_object) {
    return BoxKind::random_entries(random, count, first_object);
}

/// Returns the hits by the rule of box_sweep.hpp: blocks of rows, columns, rows.
Positions brute(const BoxSet& rows, const BoxSet& columns, SweepKind kind) {
    Positions hits;
    for (std::size_t first = 0; first < rows.size(); first += BoxSweep::row_block) {
        for (std::uint32_t k = 0; k < columns.size(); ++k) {
            for (auto i = std::uint32_t(first); i < std::min(first + BoxSweep::row_block, rows.size()); ++i) {
                const bool in_order = kind == SweepKind::self    ? k > i
                                      : kind == SweepKind::cross ? columns.low(0)[k] >= rows.low(0)[i]
                                                                 : columns.low(0)[k] > rows.low(0)[i];
                const Entry row = rows.entry(i);
                const Entry column = columns.entry(k);
                if (in_order && overlap(row, column) && (row.mask & column.mask) == 0) hits.emplace_back(i, k);
            }
        }
    }
    return hits;
}

TEST(BoxSweep, HitsComeBlockByBlockThenByColumn) {
    std::mt19937 random(1);
    for (int round = 0; round < 300; ++round) {
        const std::size_t sizes[] = {0, 1, 2, 7, 8, 9, 33, 100};
        const auto first = random_boxes(random, sizes[random() % 8], 0);
        const auto second = random_boxes(random, sizes[random() % 8], 1000);
        const unsigned axis = unsigned(random() % 3);
        const BoxSet rows = BoxKind::sorted_set(first, axis);
        const BoxSet columns = BoxKind::sorted_set(second, axis);
        for (const SweepKind kind : sweep_kinds) {
            const BoxSweep sweep{rows, kind == SweepKind::self ? rows : columns, kind};
            const Positions expected = brute(rows, sweep.columns, kind);
            ASSERT_EQ(BoxKind::positions(run(find_hits_scalar, sweep, 1000)), expected) << "round " << round;
            ASSERT_EQ(BoxKind::positions(run(find_hits, sweep, 1000)), expected) << "round " << round;
        }
    }
}

TEST(BoxSweep, HitsBecomePairsInOrder) {
    std::mt19937 random(4);
    const BoxSet rows = BoxKind::sorted_set(random_boxes(random, 300, 0), 0);
    const BoxSet columns = BoxKind::sorted_set(random_boxes(random, 200, 1000), 0);
    for (const std::uint32_t second_begin : {0u, 1000u}) {
        std::vector<BoxHits> hits(20'000);
        const BoxSweep sweep{rows, columns, SweepKind::cross};
        BoxCursor cursor;
        hits.resize(find_hits(sweep, cursor, hits));
        ASSERT_GE(cursor.row, rows.size());
        std::vector<Pair> expected, found(hits.size() * BoxHits::max_count);
        for (const auto& [row, column] : BoxKind::positions(hits)) {
            expected.push_back({rows.object()[row], columns.object()[column] - second_begin});
        }
        found.resize(write_pairs(sweep, hits, second_begin, found.data()));
        EXPECT_GT(found.size(), 100u);
        EXPECT_TRUE(same_sequence(found, expected));
    }
}

TEST(BoxSweep, KernelAndSpecificationAgreeOnWhatIsDeep) {
    std::mt19937 random(5);
    std::vector<Entry> entries = random_boxes(random, 500, 0);
    for (Entry& entry : entries) {
        entry.mask = 0;
        for (float& bound : entry.max) bound += float(random() % 3) * 1e-6f;
        if (random() % 50 == 0) entry.max[random() % 3] = 3.40282347e38f;
    }
    const BoxSet set = BoxKind::sorted_set(entries, 1);
    const BoxSweep sweep{set, set, SweepKind::self};
    const Depths depths = {0, 1e-6f, 1};
    std::vector<BoxHits> hits(100'000);
    BoxCursor cursor;
    hits.resize(find_hits(sweep, cursor, hits));
    std::vector<BoxHits> doubtful(hits.size());
    judge_hits(sweep, hits, depths, doubtful);
    std::array<std::size_t, 2> seen{};
    for (std::size_t i = 0; i < hits.size(); ++i) {
        for (const auto& [row, column] : BoxKind::positions({&hits[i], 1})) {
            const bool expected = deep(set.entry(row), set.entry(column), depths);
            ASSERT_EQ((doubtful[i].bits() >> (row - hits[i].first_row()) & 1u) == 0, expected);
            ++seen[expected ? 1 : 0];
        }
    }
    EXPECT_GT(seen[0], 100u);
    EXPECT_GT(seen[1], 100u);
}

TEST(BoxSweep, HitsMustBeDeeperTheLargerTheNumbers) {
    std::vector<Entry> entries(33);
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i] = {{0, 1, 2}, {3, 3, 3}, std::uint32_t(i), 0};
    entries[20].min[0] = -0x1p20f;
    entries[32].max[1] = 3.40282347e38f;
    const BoxSet set = BoxKind::sorted_set(entries, 2);
    const Depths depths = certain_depths({set, set, SweepKind::self}, {{0, 1, 0.5f}});
    EXPECT_EQ(depths[0], 2.0f);
    EXPECT_EQ(depths[1], std::numeric_limits<float>::infinity());
    EXPECT_EQ(depths[2], 0.5f + 6 * 0x1p-20f);
    const BoxSet other = BoxKind::sorted_set({entries[0]}, 2);
    EXPECT_EQ(certain_depths({other, set, SweepKind::cross}, {{0, 1, 0.5f}}), depths);
}

TEST(StartOrder, SortsByLowEndThenPosition) {
    std::mt19937 random(6);
    for (const std::size_t count : {0, 1, 2, 24, 25, 500, 4096}) {
        for (const float far : {1.0f, 3e38f}) {  // one far box crowds all others into one bucket
            std::vector<Entry> entries = random_boxes(random, count, 0);
            for (Entry& entry : entries) {
                entry.min[2] = float(random() % 1000) / 8 - 50;
                entry.max[2] = entry.min[2] + 1;
            }
            if (count > 0) entries[count / 2].max[2] = entries[count / 2].min[2] = far;
            StartOrder order({});
            NoPairs none;
            SerialExecutor serial(none);
            const GivenSource source(entries, 0);
            const std::vector<EntryId> ids = ids_of(entries);
            const std::span<const SortKey> keys = order.sort({source, ids}, 2, serial);
            const BoxSet expected = BoxKind::sorted_set(entries, 2);
            ASSERT_EQ(keys.size(), count);
            for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(position_of(keys[i]), expected.object()[i]);
        }
    }
}

TEST(BoxSweep, FarBoxesTouchTheLargestFiniteNumbersOnly) {
    const float most = 3.40282347e38f;
    std::vector<Entry> entries(2);
    entries[0] = {{-most, -most, -most}, {most, most, most}, 0, 0};
    entries[1] = {{most, most, most}, {most, most, most}, 1, 0};
    const BoxSet set = BoxKind::sorted_set(entries, 0);
    const BoxSweep sweep{set, set, SweepKind::self};
    EXPECT_EQ(BoxKind::positions(run(find_hits, sweep, 10)), (Positions{{0, 1}}));
}

}  // namespace
}  // namespace octopair::test
