// Tests the sweep's SIMD kernel against its scalar specification, and both against a test of all boxes.

#include "octree/sweep/sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "octree/given_source.hpp"
#include "octree/sweep/start_order.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

using Hits = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::vector<Entry> random_entries(std::mt19937& random, std::size_t count, std::uint32_t first_object) {
    std::uniform_int_distribution<int> place(0, 12), length(0, 3), mask(0, 31);
    std::vector<Entry> entries(count);
    for (std::size_t i = 0; i < count; ++i) {
        const int times = random() % 16 == 0 ? 5 : 1;  // a few boxes are far longer
        for (int axis = 0; axis < 3; ++axis) {
            entries[i].min[axis] = float(place(random));
            entries[i].max[axis] = entries[i].min[axis] + float(times * length(random));
        }
        entries[i].object = first_object + std::uint32_t(i);
        entries[i].mask = std::uint32_t(mask(random) & mask(random) & mask(random));
    }
    return entries;
}

SweepSet sorted_set(const std::vector<Entry>& entries, unsigned axis) {
    std::vector<SortKey> order(entries.size());
    for (std::uint32_t i = 0; i < entries.size(); ++i) order[i] = sort_key(entries[i].min[axis], i);
    std::sort(order.begin(), order.end());
    std::vector<Entry> sorted;
    for (const SortKey key : order) sorted.push_back(entries[position_of(key)]);
    SweepSet set;
    set.assign(sorted, axis);
    return set;
}

using Kernel = std::size_t (*)(const Sweep&, SweepCursor&, std::span<HitMask>);

template <typename Body>
void for_each_bit(const HitMask& hit, Body&& body) {
    for (unsigned bit = 0; bit < block_size; ++bit) {
        if (hit.bits() >> bit & 1u) body(hit.first_row() + bit);
    }
}

/// Returns all hits, collected through a queue of `room` masks.
Hits run(Kernel kernel, const Sweep& sweep, std::size_t room) {
    Hits hits;
    std::vector<HitMask> queue(room);
    SweepCursor cursor;
    while (cursor.row < sweep.rows.size()) {
        const std::size_t count = kernel(sweep, cursor, queue);
        for (const HitMask& hit : std::span(queue).first(count)) {
            for_each_bit(hit, [&](std::uint32_t row) { hits.emplace_back(row, hit.column()); });
        }
    }
    return hits;
}

/// Returns the hits by the rule of sweep.hpp: blocks of rows, columns, rows.
Hits brute(const SweepSet& rows, const SweepSet& columns, SweepKind kind) {
    Hits hits;
    for (std::size_t first = 0; first < rows.size(); first += block_size) {
        for (std::uint32_t k = 0; k < columns.size(); ++k) {
            for (auto i = std::uint32_t(first); i < std::min(first + block_size, rows.size()); ++i) {
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

TEST(Sweep, KernelAndSpecificationFindTheSameHitsInTheSameOrder) {
    std::mt19937 random(1);
    for (int round = 0; round < 300; ++round) {
        const std::size_t sizes[] = {0, 1, 2, 7, 8, 9, 33, 100};
        const auto first = random_entries(random, sizes[random() % 8], 0);
        const auto second = random_entries(random, sizes[random() % 8], 1000);
        const unsigned axis = unsigned(random() % 3);
        const SweepSet rows = sorted_set(first, axis);
        const SweepSet columns = sorted_set(second, axis);
        for (const SweepKind kind : {SweepKind::self, SweepKind::cross, SweepKind::cross_strict}) {
            const SweepSet& others = kind == SweepKind::self ? rows : columns;
            const Hits expected = brute(rows, others, kind);
            for (const std::size_t room : {max_columns, max_columns + 3, std::size_t(1000)}) {
                ASSERT_EQ(run(sweep_rows_scalar, {rows, others, kind}, room), expected) << "round " << round;
                ASSERT_EQ(run(sweep_rows, {rows, others, kind}, room), expected) << "round " << round;
            }
        }
    }
}

TEST(Sweep, HitsBecomePairsInOrder) {
    std::mt19937 random(4);
    const SweepSet rows = sorted_set(random_entries(random, 300, 0), 0);
    const SweepSet columns = sorted_set(random_entries(random, 200, 1000), 0);
    for (const std::uint32_t second_begin : {0u, 1000u}) {
        std::vector<HitMask> hits(20'000);
        const Sweep sweep{rows, columns, SweepKind::cross};
        SweepCursor cursor;
        hits.resize(sweep_rows(sweep, cursor, hits));
        ASSERT_GE(cursor.row, rows.size());
        std::vector<Pair> expected, found(hits.size() * max_hits);
        for (const HitMask& hit : hits) {
            for_each_bit(hit, [&](std::uint32_t row) {
                expected.push_back({rows.object()[row], columns.object()[hit.column()] - second_begin});
            });
        }
        found.resize(pairs_of_hits(sweep, hits, second_begin, found.data()));
        EXPECT_GT(found.size(), 100u);
        EXPECT_TRUE(same_sequence(found, expected));
    }
}

TEST(Sweep, KernelAndSpecificationAgreeOnWhatIsDeep) {
    std::mt19937 random(5);
    std::vector<Entry> entries = random_entries(random, 500, 0);
    for (Entry& entry : entries) {
        entry.mask = 0;
        for (float& bound : entry.max) bound += float(random() % 3) * 1e-6f;
        if (random() % 50 == 0) entry.max[random() % 3] = 3.40282347e38f;
    }
    const SweepSet set = sorted_set(entries, 1);
    const Sweep sweep{set, set, SweepKind::self};
    const Depths depths = {0, 1e-6f, 1};
    std::vector<HitMask> hits(100'000);
    SweepCursor cursor;
    hits.resize(sweep_rows(sweep, cursor, hits));
    std::vector<HitMask> kept = hits;
    keep_deep(sweep, depths, kept);
    std::array<std::size_t, 2> seen{};
    for (std::size_t i = 0; i < hits.size(); ++i) {
        for_each_bit(hits[i], [&](std::uint32_t row) {
            const bool expected = deep(set.entry(row), set.entry(hits[i].column()), depths);
            ASSERT_EQ((kept[i].bits() >> (row - hits[i].first_row()) & 1u) != 0, expected);
            ++seen[expected ? 1 : 0];
        });
    }
    EXPECT_GT(seen[0], 100u);
    EXPECT_GT(seen[1], 100u);
}

TEST(Sweep, HitsMustBeDeeperTheLargerTheNumbers) {
    std::vector<Entry> entries(33);
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i] = {{0, 1, 2}, {3, 3, 3}, std::uint32_t(i), 0};
    entries[20].min[0] = -0x1p20f;
    entries[32].max[1] = 3.40282347e38f;
    const SweepSet set = sorted_set(entries, 2);
    const Depths depths = certain_depths({set, set, SweepKind::self}, {{0, 1, 0.5f}});
    EXPECT_EQ(depths[0], 2.0f);
    EXPECT_EQ(depths[1], std::numeric_limits<float>::infinity());
    EXPECT_EQ(depths[2], 0.5f + 6 * 0x1p-20f);
    const SweepSet other = sorted_set({entries[0]}, 2);
    EXPECT_EQ(certain_depths({other, set, SweepKind::cross}, {{0, 1, 0.5f}}), depths);
}

TEST(StartOrder, SortsByLowEndThenPosition) {
    std::mt19937 random(6);
    for (const std::size_t count : {0, 1, 2, 24, 25, 500, 4096}) {
        for (const float far : {1.0f, 3e38f}) {  // one far box crowds all others into one bucket
            std::vector<Entry> entries = random_entries(random, count, 0);
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
            const SweepSet expected = sorted_set(entries, 2);
            ASSERT_EQ(keys.size(), count);
            for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(position_of(keys[i]), expected.object()[i]);
        }
    }
}

TEST(Sweep, CrossingBothWaysFindsEachPairOnce) {
    std::mt19937 random(2);
    const SweepSet rows = sorted_set(random_entries(random, 60, 0), 0);
    const SweepSet columns = sorted_set(random_entries(random, 80, 1000), 0);
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> found;
    for (const auto& [i, k] : run(sweep_rows, {rows, columns, SweepKind::cross}, 100)) found.insert({i, k});
    for (const auto& [k, i] : run(sweep_rows, {columns, rows, SweepKind::cross_strict}, 100)) found.insert({i, k});
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> expected;
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
        for (std::uint32_t k = 0; k < columns.size(); ++k) {
            const Entry row = rows.entry(i), column = columns.entry(k);
            if (overlap(row, column) && (row.mask & column.mask) == 0) expected.insert({i, k});
        }
    }
    EXPECT_EQ(found, expected);
}

TEST(Sweep, BaselineInstructionSetFindsTheSameHits) {
    std::mt19937 random(3);
    const SweepSet set = sorted_set(random_entries(random, 2000, 0), 1);
    const Hits best = run(sweep_rows, {set, set, SweepKind::self}, 50);
    restrict_sweep_to_baseline(true);
    const std::string restricted = sweep_instruction_set();
    const Hits baseline = run(sweep_rows, {set, set, SweepKind::self}, 50);
    restrict_sweep_to_baseline(false);
    EXPECT_EQ(best, baseline) << "against " << restricted;
    EXPECT_GT(best.size(), 1000u);
}

TEST(Sweep, FarBoxesTouchTheLargestFiniteNumbersOnly) {
    const float most = 3.40282347e38f;
    std::vector<Entry> entries(2);
    entries[0] = {{-most, -most, -most}, {most, most, most}, 0, 0};
    entries[1] = {{most, most, most}, {most, most, most}, 1, 0};
    const SweepSet set = sorted_set(entries, 0);
    EXPECT_EQ(run(sweep_rows, {set, set, SweepKind::self}, 10), (Hits{{0, 1}}));
}

}  // namespace
}  // namespace octopair::test
