// Tests what is special to the sweep on cells: the layout of its sets, calls of bounded length, and certain hits against the caller's own
// numbers. sweep_test.cpp has the tests of both kinds of sweep.
#include "octree/sweep/cell_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "base/tuning.hpp"
#include "boxes/box_source.hpp"
#include "octree/sweep_kinds.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

std::vector<CellEntry> random_cells(std::mt19937& random, std::size_t count, std::uint32_t first_object,
                                    std::uint32_t max_extent = 4000) {
    return CellKind::random_entries(random, count, first_object, max_extent);
}

constexpr std::size_t sizes[] = {0, 1, 2, 3, 4, 5, 31, 40, 63, 64, 65, 100, 130, 700};

TEST(CellSet, SortsByBucketThenPosition) {
    std::mt19937 random(1);
    for (const std::size_t size : sizes) {
        const auto entries = random_cells(random, size, 0);
        const CellSet set = CellKind::sorted_set(entries);
        ASSERT_EQ(set.size(), size);
        const auto bucket = [&](const CellEntry& entry) { return entry.low(0) >> set.bucket_shift(); };
        std::vector<CellEntry> expected = entries;
        std::ranges::stable_sort(expected, {}, bucket);
        for (std::size_t i = 0; i < size; ++i) {
            ASSERT_EQ(set.entries()[i].object, expected[i].object);
            ASSERT_EQ(set.entries()[i].ends, expected[i].ends);
            const auto bytes = plane_bytes(expected[i]);
            for (std::size_t k = 0; k < cell_planes; ++k) ASSERT_EQ(set.plane(CellPlane(k))[i], bytes[k]);
            const auto end = std::ranges::upper_bound(expected, bucket(expected[i]), {}, bucket);
            ASSERT_EQ(set.bucket_begins()[bucket(expected[i]) + 1], std::uint32_t(end - expected.begin()));
        }
    }
}

// Numbers that change while they are read may give an entry whose high end lies before its low end. Its hits must be columns of the
// set, too.
TEST(CellSweep, EntriesThatEndBeforeTheyBeginHitOnlyColumnsOfTheSet) {
    std::mt19937 random(8);
    for (int round = 0; round < 300; ++round) {
        std::vector<CellEntry> entries = random_cells(random, sizes[random() % std::size(sizes)], 0);
        for (CellEntry& entry : entries) {
            std::uint32_t& ends = entry.ends[random() % 3];
            if (random() % 3 == 0) ends = (ends << 16 | ends >> 16) & CellEntry::end_bits;
        }
        const CellSet rows = CellKind::sorted_set(entries);
        const CellSet columns = CellKind::sorted_set(random_cells(random, 40, 1000));
        for (const SweepKind kind : sweep_kinds) {
            const CellSweep sweep{rows, kind == SweepKind::self ? rows : columns, kind};
            const std::vector<CellHit> hits = run(find_hits, sweep, 1000);
            for (const CellHit hit : hits) {
                ASSERT_LT(hit >> 16, rows.size());
                ASSERT_LT(hit & 0xFFFFu, sweep.columns.size());
            }
            ASSERT_EQ(hits, run(find_hits_scalar, sweep, 1000)) << "round " << round;
        }
    }
}

TEST(CellSweep, CallsTakeABoundedNumberOfRows) {
    std::mt19937 random(7);
    const CellSet rows = CellKind::sorted_set(random_cells(random, 2 * tuning().sweep.cell_rows_per_call + 10, 0, 40));
    const CellSet columns = CellKind::sorted_set(random_cells(random, 100, 10'000, 40));
    for (const SweepKind kind : sweep_kinds) {
        const CellSweep sweep{rows, kind == SweepKind::self ? rows : columns, kind};
        const std::size_t room = 10'000'000;
        std::vector<CellHit> hits(room);
        CellCursor cursor;
        (void)find_hits(sweep, cursor, hits);
        EXPECT_EQ(cursor.row, tuning().sweep.cell_rows_per_call);
        ASSERT_EQ(run(find_hits, sweep, room), run(find_hits_scalar, sweep, room));
    }
}

TEST(JudgeHits, KernelAndSpecificationAgree) {
    std::mt19937 random(4);
    std::size_t certain = 0, doubted = 0;
    for (int round = 0; round < 200; ++round) {
        const CellSet rows = CellKind::sorted_set(random_cells(random, 300, 0, 40'000));
        const CellSet columns = CellKind::sorted_set(random_cells(random, 300, 1000, 40'000));
        const CellSweep sweep{rows, columns, SweepKind::cross};
        CellDepths depths;
        for (std::uint16_t& cells : depths.cells) cells = std::uint16_t(random() % 3 == 0 ? 32767 : 1 + random() % 3);
        depths.none_certain = random() % 8 == 0;
        std::vector<CellHit> hits(random() % 50);
        for (CellHit& hit : hits) hit = CellHit(random() % 300 << 16 | random() % 300);
        if (random() % 2 == 0 && !hits.empty()) {
            for (CellHit& hit : hits) hit = (hits[0] & 0xFFFF0000u) | (hit & 0xFFFFu);
        }
        struct Room {
            std::vector<Pair> pairs = std::vector<Pair>(100);
            std::vector<std::uint32_t> doubtful = std::vector<std::uint32_t>(100);
        };
        Room room, expected_room;
        JudgedHits expected{.pairs = expected_room.pairs.data(), .doubtful = expected_room.doubtful.data()};
        judge_hits_scalar(sweep, hits, depths, expected);
        JudgedHits judged{.pairs = room.pairs.data(), .doubtful = room.doubtful.data()};
        const std::size_t count = hits.size();
        hits.resize(count + judged_room);
        judge_hits(sweep, std::span(hits).first(count), depths, judged);
        room.pairs.resize(judged.pair_count);
        expected_room.pairs.resize(expected.pair_count);
        ASSERT_TRUE(same_sequence(room.pairs, expected_room.pairs));
        room.doubtful.resize(judged.doubtful_count);
        expected_room.doubtful.resize(expected.doubtful_count);
        ASSERT_EQ(room.doubtful, expected_room.doubtful);
        doubted += judged.doubtful_count;
        certain += judged.pair_count - judged.doubtful_count;
    }
    EXPECT_GT(certain, 100u);
    EXPECT_GT(doubted, 100u);
}

/// A source of random boxes, with an octant of a space that is fitted to them.
struct RoundedScene {
    explicit RoundedScene(std::mt19937& random) {
        const double scale = std::pow(10.0, double(random() % 12) - 6), far = random() % 3 == 0 ? 1e6 * scale : 0;
        std::uniform_real_distribution<double> place(0, 1), length(0, 0.3);
        const std::size_t count = 120;
        for (std::size_t i = 0; i < count; ++i) {
            Box3d box;
            for (unsigned axis = 0; axis < 3; ++axis) {
                const double grid = random() % 2 == 0 ? 16 : 1e9;  // many equal ends
                box.min[axis] = far + scale * std::floor(place(random) * grid) / grid;
                box.max[axis] = box.min[axis] + scale * std::floor(length(random) * grid) / grid;
            }
            wide.push_back(box);
            narrow.push_back({{float(box.min[0]), float(box.min[1]), float(box.min[2])},
                              {float(box.max[0]), float(box.max[1]), float(box.max[2])}});
            padding.push_back(random() % 2 == 0 ? 0 : scale / 64);
        }
        const bool padded = random() % 3 == 0;
        const std::span<const double> paddings = padded ? std::span<const double>(padding) : std::span<const double>();
        const bool is_narrow = random() % 2 == 0;
        objects = is_narrow ? Objects{narrow, paddings} : Objects{wide, paddings};
        source.emplace(objects, nullptr, random() % 2 == 0 ? 0 : scale / 16);
        std::vector<Entry> entries(count);
        EXPECT_TRUE(source->load(0, entries));
        space = Space::fit(entries, 1'000'000);
        const unsigned level = unsigned(random() % (deepest + 1));
        const CellBox box = space.cells(entries[random() % count]);
        Octant octant{};
        octant.level = level;
        for (unsigned axis = 0; axis < 3; ++axis)
            octant.lo[axis] = box.lo[axis] >> (deepest - level) << (deepest - level);
        cells = OctantCells(space, octant);
        inside.resize(count);
        cell_entries(cells, entries, inside.data());
        for (std::size_t i = 0; i < count; ++i) {
            const CellEntry expected = cells.entry(entries[i]);
            EXPECT_EQ(inside[i].ends, expected.ends);
            EXPECT_EQ(inside[i].object, expected.object);
        }
    }

    std::vector<Box3d> wide;
    std::vector<Box3f> narrow;
    std::vector<double> padding;
    Objects objects;
    std::optional<BoxSource> source;
    Space space;
    OctantCells cells;
    std::vector<CellEntry> inside;
};

// An octant has only entries that touch it. Entries that do not touch it are clamped, and have the same properties.
TEST(CellDepths, HoldByTheCallersNumbers) {
    std::mt19937 random(5);
    std::size_t certain = 0, doubted = 0, apart = 0;
    for (int round = 0; round < 2000; ++round) {
        RoundedScene scene(random);
        const CellDepths depths = certain_depths(scene.cells, *scene.source);
        const CellSet set = CellKind::sorted_set(scene.inside);
        std::vector<CellHit> hits(400);
        for (CellHit& hit : hits) hit = CellHit(random() % set.size() << 16 | random() % set.size());
        for (const CellHit hit : hits) {
            const CellEntry &a = set.entries()[hit >> 16], &b = set.entries()[hit & 0xFFFFu];
            int depth = last_octant_cell;
            bool is_certain = !depths.none_certain;
            for (unsigned k = 0; k < 3; ++k) {
                const int on_axis = std::min(int(a.high(k)) - int(b.low(k)), int(b.high(k)) - int(a.low(k)));
                depth = std::min(depth, on_axis);
                is_certain &= on_axis >= int(depths.cells[k]);
            }
            const bool pair = scene.source->is_pair(a.object, b.object);
            if (depth < 0) {
                ++apart;
                ASSERT_FALSE(pair) << "round " << round;
            } else if (is_certain) {
                ++certain;
                ASSERT_TRUE(pair) << "round " << round;
            } else {
                ++doubted;
            }
        }
    }
    EXPECT_GT(certain, 1000u);
    EXPECT_GT(doubted, 10'000u);
    EXPECT_GT(apart, 10'000u);
}

TEST(BoxSource, RefusesDoubtfulPairsByTheCallersNumbers) {
    std::mt19937 random(6);
    std::size_t refused_count = 0, all = 0;
    for (int round = 0; round < 300; ++round) {
        RoundedScene scene(random);
        std::vector<Pair> pairs(100);
        for (Pair& pair : pairs) {
            pair.a = std::uint32_t(random() % scene.wide.size());
            pair.b = std::uint32_t(random() % scene.wide.size());
        }
        std::vector<std::uint32_t> doubtful, expected, refused(pairs.size());
        for (std::uint32_t i = 0; i < pairs.size(); ++i) {
            if (random() % 3 == 0) continue;
            doubtful.push_back(i);
            if (!scene.source->is_pair(pairs[i].a, pairs[i].b)) expected.push_back(i);
        }
        refused.resize(scene.source->refused({pairs, doubtful}, refused.data()));
        ASSERT_EQ(refused, expected);
        refused_count += refused.size();
        all += doubtful.size();
    }
    EXPECT_GT(refused_count, 1000u);
    EXPECT_GT(all - refused_count, 100u);
}

}  // namespace
}  // namespace octopair::test
