// Tests the sweep on cells: its SIMD kernels against their scalar specifications, these against a test of all entries, and
// certain hits against the caller's own numbers.
#include "octree/sweep/cell_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "base/tuning.hpp"
#include "boxes/box_source.hpp"
#include "support/compare.hpp"

namespace octopair::test {
namespace {

/// Random entries of an octant. A few fill the octant; many have equal ends.
std::vector<CellEntry> random_entries(std::mt19937& random, std::size_t count, std::uint32_t first_object,
                                      std::uint32_t max_extent = 4000) {
    std::vector<CellEntry> entries(count);
    const std::uint32_t step = random() % 2 == 0 ? 1 : 800;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::uint32_t& ends : entries[i].ends) {
            auto low = std::uint32_t(random() % (last_octant_cell + 1)) / step * step;
            auto high = std::min(low + std::uint32_t(random() % max_extent) / step * step, last_octant_cell);
            if (random() % 20 == 0) low = 0;
            if (random() % 20 == 0) high = last_octant_cell;
            ends = low | high << 16 | (std::uint32_t(random() & random() & random()) & CellEntry::flag_bits);
        }
        entries[i].object = first_object + std::uint32_t(i);
    }
    return entries;
}

CellSet sorted_set(std::span<const CellEntry> entries) {
    // Several runs, as an octree has them.
    std::vector<std::span<const CellEntry>> runs;
    for (std::size_t begin = 0; begin < entries.size(); begin += 7) {
        runs.push_back(entries.subspan(begin, std::min<std::size_t>(7, entries.size() - begin)));
    }
    CellSet set;
    set.assign(runs);
    set.make_planes();
    return set;
}

constexpr std::size_t sizes[] = {0, 1, 2, 3, 4, 5, 31, 40, 63, 64, 65, 100, 130, 700};

TEST(CellSet, SortsByBucketThenPosition) {
    std::mt19937 random(1);
    for (const std::size_t size : sizes) {
        const auto entries = random_entries(random, size, 0);
        const CellSet set = sorted_set(entries);
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

using Kernel = std::size_t (*)(const CellSweep&, CellCursor&, std::span<CellHit>);

std::vector<CellHit> run(Kernel kernel, const CellSweep& sweep, std::size_t room) {
    std::vector<CellHit> hits, some(room);
    CellCursor cursor;
    while (cursor.row < sweep.rows.size()) {
        const std::size_t count = kernel(sweep, cursor, some);
        hits.insert(hits.end(), some.begin(), some.begin() + std::ptrdiff_t(count));
    }
    return hits;
}

/// Returns the pairs of objects that a sweep finds.
std::vector<Pair> pairs_of(const CellSweep& sweep) {
    std::vector<CellHit> hits = run(cell_hits_scalar, sweep, 1000);
    std::vector<Pair> pairs(hits.size() + judged_room);
    std::vector<std::uint32_t> doubtful(hits.size() + judged_room);
    JudgedHits judged{.pairs = pairs.data(), .doubtful = doubtful.data()};
    judge_hits_scalar(sweep, hits, {}, judged);
    pairs.resize(judged.pair_count);
    return pairs;
}

TEST(CellSweep, KernelAndSpecificationFindTheSameHitsInTheSameOrder) {
    std::mt19937 random(2);
    for (int round = 0; round < 200; ++round) {
        const CellSet rows = sorted_set(random_entries(random, sizes[random() % std::size(sizes)], 0));
        const CellSet columns = sorted_set(random_entries(random, sizes[random() % std::size(sizes)], 1000));
        for (const SweepKind kind : {SweepKind::self, SweepKind::cross, SweepKind::cross_strict}) {
            const CellSweep sweep{rows, kind == SweepKind::self ? rows : columns, kind};
            const std::vector<CellHit> expected = run(cell_hits_scalar, sweep, 100'000);
            for (const std::size_t room : {min_hit_room, min_hit_room + 5, std::size_t(4000)}) {
                ASSERT_EQ(run(cell_hits_scalar, sweep, room), expected) << "round " << round;
                ASSERT_EQ(run(cell_hits, sweep, room), expected) << "round " << round;
            }
        }
    }
}

// Numbers that change while they are read may give an entry whose high end lies before its low end. Its hits must be columns of the
// set, too.
TEST(CellSweep, EntriesThatEndBeforeTheyBeginHitOnlyColumnsOfTheSet) {
    std::mt19937 random(8);
    for (int round = 0; round < 300; ++round) {
        std::vector<CellEntry> entries = random_entries(random, sizes[random() % std::size(sizes)], 0);
        for (CellEntry& entry : entries) {
            std::uint32_t& ends = entry.ends[random() % 3];
            if (random() % 3 == 0) ends = (ends << 16 | ends >> 16) & CellEntry::end_bits;
        }
        const CellSet rows = sorted_set(entries);
        const CellSet columns = sorted_set(random_entries(random, 40, 1000));
        for (const SweepKind kind : {SweepKind::self, SweepKind::cross, SweepKind::cross_strict}) {
            const CellSweep sweep{rows, kind == SweepKind::self ? rows : columns, kind};
            const std::vector<CellHit> hits = run(cell_hits, sweep, 1000);
            for (const CellHit hit : hits) {
                ASSERT_LT(hit >> 16, rows.size());
                ASSERT_LT(hit & 0xFFFFu, sweep.columns.size());
            }
            ASSERT_EQ(hits, run(cell_hits_scalar, sweep, 1000)) << "round " << round;
        }
    }
}

TEST(CellSweep, CallsTakeABoundedNumberOfRows) {
    std::mt19937 random(7);
    const CellSet rows = sorted_set(random_entries(random, 2 * tuning().sweep.cell_rows_per_call + 10, 0, 40));
    const CellSet columns = sorted_set(random_entries(random, 100, 10'000, 40));
    for (const SweepKind kind : {SweepKind::self, SweepKind::cross, SweepKind::cross_strict}) {
        const CellSweep sweep{rows, kind == SweepKind::self ? rows : columns, kind};
        const std::size_t room = 10'000'000;
        std::vector<CellHit> hits(room);
        CellCursor cursor;
        (void)cell_hits(sweep, cursor, hits);
        EXPECT_EQ(cursor.row, tuning().sweep.cell_rows_per_call);
        ASSERT_EQ(run(cell_hits, sweep, room), run(cell_hits_scalar, sweep, room));
    }
}

TEST(CellSweep, FindsEachPairOnce) {
    std::mt19937 random(3);
    const auto overlap = [](const CellEntry& a, const CellEntry& b) {
        bool overlaps = reports(a, b);
        for (unsigned k = 0; k < 3; ++k) overlaps &= a.low(k) <= b.high(k) && b.low(k) <= a.high(k);
        return overlaps;
    };
    using Found = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;
    const auto add = [](Found& to, const std::vector<Pair>& pairs) {
        for (const Pair& pair : pairs) to.emplace(pair.a, pair.b);
    };
    std::size_t all = 0;
    for (int round = 0; round < 50; ++round) {
        const auto first = random_entries(random, sizes[random() % std::size(sizes)], 0);
        const auto second = random_entries(random, sizes[random() % std::size(sizes)], 1000);
        const CellSet rows = sorted_set(first), columns = sorted_set(second);
        Found expected, found;
        for (std::size_t i = 0; i < first.size(); ++i) {
            for (std::size_t k = i + 1; k < first.size(); ++k) {
                if (overlap(first[i], first[k])) expected.emplace(first[i].object, first[k].object);
            }
        }
        add(found, pairs_of({rows, rows, SweepKind::self}));
        ASSERT_EQ(found, expected);
        expected.clear();
        found.clear();
        for (const CellEntry& a : first) {
            for (const CellEntry& b : second) {
                if (overlap(a, b)) expected.emplace(a.object, b.object);
            }
        }
        add(found, pairs_of({rows, columns, SweepKind::cross}));
        add(found, pairs_of({columns, rows, SweepKind::cross_strict}));
        ASSERT_EQ(found, expected);
        all += found.size();
    }
    EXPECT_GT(all, 1000u);
}

TEST(JudgeHits, KernelAndSpecificationAgree) {
    std::mt19937 random(4);
    std::size_t certain = 0, doubted = 0;
    for (int round = 0; round < 200; ++round) {
        const CellSet rows = sorted_set(random_entries(random, 300, 0, 40'000));
        const CellSet columns = sorted_set(random_entries(random, 300, 1000, 40'000));
        const CellSweep sweep{rows, columns, SweepKind::cross};
        CertainGaps gaps;
        for (std::uint16_t& cells : gaps.cells) cells = std::uint16_t(random() % 3 == 0 ? 32767 : 1 + random() % 3);
        gaps.none_certain = random() % 8 == 0;
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
        judge_hits_scalar(sweep, hits, gaps, expected);
        JudgedHits judged{.pairs = room.pairs.data(), .doubtful = room.doubtful.data()};
        const std::size_t count = hits.size();
        hits.resize(count + judged_room);
        judge_hits(sweep, std::span(hits).first(count), gaps, judged);
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
TEST(CertainGaps, HoldByTheCallersNumbers) {
    std::mt19937 random(5);
    std::size_t certain = 0, doubted = 0, apart = 0;
    for (int round = 0; round < 2000; ++round) {
        RoundedScene scene(random);
        const CertainGaps gaps = certain_gaps(scene.cells, *scene.source);
        const CellSet set = sorted_set(scene.inside);
        std::vector<CellHit> hits(400);
        for (CellHit& hit : hits) hit = CellHit(random() % set.size() << 16 | random() % set.size());
        for (const CellHit hit : hits) {
            const CellEntry &a = set.entries()[hit >> 16], &b = set.entries()[hit & 0xFFFFu];
            int depth = last_octant_cell;
            bool is_certain = !gaps.none_certain;
            for (unsigned k = 0; k < 3; ++k) {
                const int on_axis = std::min(int(a.high(k)) - int(b.low(k)), int(b.high(k)) - int(a.low(k)));
                depth = std::min(depth, on_axis);
                is_certain &= on_axis >= int(gaps.cells[k]);
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
