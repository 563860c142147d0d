// Tests the sweeps of large and crowded sets against a test of all pairs of boxes.
#include "octree/sweep/recursive_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "baselines/baselines.hpp"
#include "octopair/error.hpp"
#include "octree/given_source.hpp"
#include "octree/scan/scan.hpp"
#include "octree/sweep/start_order.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

class CollectingWriter final : public ShareWriter {
public:
    bool counting() const override { return false; }
    void write(std::span<const Pair> pairs) override { found.insert(found.end(), pairs.begin(), pairs.end()); }
    void write_count(std::uint64_t) override { FAIL() << "expected pairs, not a number of pairs"; }

    std::vector<Pair> found;
};

enum class Shape : std::uint8_t { cubes, rods, coincident, lattice };

std::vector<Entry> make_entries(Shape shape, std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    // Many objects have more room, because otherwise rods and boxes of the lattice would form millions of pairs.
    const bool many = count > 1000;
    const float room = many && shape == Shape::rods ? 60.0f : 10.0f;
    const unsigned lattice_places = many ? 24 : 4;
    std::uniform_real_distribution<float> place(0, room), length(0, 1);
    std::vector<Entry> entries(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t long_axis = shape == Shape::rods ? i % 3 : 3;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            float low = place(random), high = low + length(random);
            if (axis == long_axis) low = 0, high = room + 1;
            if (shape == Shape::coincident) low = 1, high = 2;
            if (shape == Shape::lattice) low = float(random() % lattice_places), high = low + float(random() % 2);
            entries[i].min[axis] = low;
            entries[i].max[axis] = high;
        }
        entries[i].object = std::uint32_t(i);
        entries[i].mask = 0;
    }
    return entries;
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs sorted(const std::vector<Pair>& found) {
    Pairs pairs;
    for (const Pair& pair : found) pairs.emplace_back(pair.a, pair.b);
    std::ranges::sort(pairs);
    return pairs;
}

Pairs brute_force(const std::vector<Entry>& entries) {
    std::vector<Box3f> boxes(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        std::ranges::copy(entries[i].min, boxes[i].min);
        std::ranges::copy(entries[i].max, boxes[i].max);
    }
    return sorted(baselines::naive_pairs(boxes));
}

/// Returns the pairs of an object before `begin` with one from there on. The numbers of the latter begin at 0.
Pairs across(const Pairs& pairs, std::size_t begin) {
    Pairs found;
    for (const auto& [a, b] : pairs) {
        if (a < begin && b >= begin) found.emplace_back(a, std::uint32_t(b - begin));
    }
    return found;
}

class SweepsOf : public ::testing::TestWithParam<Shape> {
protected:
    using Method = void (*)(const ScanContext&, const SweepInput&, Executor&);

    void expect_all_pairs(std::size_t count, Method method) const {
        const std::vector<Entry> entries = make_entries(GetParam(), count, unsigned(count));
        const std::vector<EntryId> ids = ids_of(entries);
        const GivenSource one_set(entries, 0);
        const EntryList all(one_set, ids);
        const EntryList whole{std::span<const Entry>(entries)};
        const Pairs expected = brute_force(entries);
        expect_pairs(one_set, {all, all, true}, expected, method);
        expect_pairs(one_set, {whole, whole, true}, expected, method);
        const std::size_t half = count / 3;
        const GivenSource two_sets(entries, std::uint32_t(half));
        const EntryList rows(two_sets, std::span(ids).first(half)), columns(two_sets, std::span(ids).subspan(half));
        expect_pairs(two_sets, {rows, columns, false}, across(expected, half), method);
    }

private:
    static void expect_pairs(const EntrySource& source, const SweepInput& input, const Pairs& expected, Method method) {
        ScanMemoryPool memory;
        const ScanContext context{source, {}, memory};
        CollectingWriter writer;
        SerialExecutor executor(writer);
        method(context, input, executor);
        EXPECT_EQ(sorted(writer.found), expected) << (input.self ? "one set" : "two sets");
    }
};

// More than two tiles of 4,096 rows, so that rows meet the columns of other tiles.
TEST_P(SweepsOf, TiledSweepFindsAllPairs) {
    for (const std::size_t count : {1u, 2u, 300u, 9'000u}) {
        if (GetParam() == Shape::coincident && count > 300) continue;  // 40 million pairs
        expect_all_pairs(count, [](const ScanContext& context, const SweepInput& input, Executor& executor) {
            tiled_sweep(context, input, 0, executor);
        });
    }
}

TEST_P(SweepsOf, TheAxisDoesNotMatter) {
    expect_all_pairs(700, [](const ScanContext& context, const SweepInput& input, Executor& executor) {
        tiled_sweep(context, input, 2, executor);
    });
}

TEST_P(SweepsOf, RecursiveSweepFindsAllPairs) {
    for (const std::size_t count : {1u, 2u, 3u, 50u, 700u, 6'000u}) {
        if (GetParam() == Shape::coincident && count > 700) continue;
        expect_all_pairs(count, recursive_sweep);
    }
}

/// Boxes that move up whenever they are read again. A recursive sweep reads columns to choose a value, and again to split them at this
/// value. At the second time all columns are above the value, so no split divides them.
class RisingSource final : public GivenSource {
public:
    static constexpr std::uint32_t rows = 600, columns = 600;

    RisingSource() : GivenSource({}, rows) {}
    void load_bounds(std::span<Entry> entries) const override {
        if (!entries.empty() && entries[0].object % rows == 0) height_ += 10;
        for (Entry& entry : entries) {
            const std::uint32_t object = entry.object;
            for (unsigned axis = 0; axis < 3; ++axis) {
                // Each column is below all rows on one axis. So on each axis a sweep tests many columns, but no pair overlaps.
                const bool below = object >= rows && (object + 1) % 3 == axis;
                entry.min[axis] = object < rows ? height_ - 9 : below ? -1 : height_ + float(object % 2);
                entry.max[axis] = below ? 0 : 1e9f;
            }
        }
    }

private:
    mutable float height_ = 0;
};

TEST(RecursiveSweep, EndsIfBoxesChange) {
    const RisingSource source;
    std::vector<EntryId> row_ids, column_ids;
    for (std::uint32_t i = 0; i < source.rows; ++i) row_ids.push_back({i, 0});
    for (std::uint32_t i = 0; i < source.columns; ++i) column_ids.push_back({source.rows + i, 0});
    ScanMemoryPool memory;
    const ScanContext context{source, {}, memory};
    CollectingWriter writer;
    SerialExecutor executor(writer);
    const SweepInput join{EntryList(source, row_ids), EntryList(source, column_ids), false, {}};
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { recursive_sweep(context, join, executor); }),
              "an object changed while it was read");
}

INSTANTIATE_TEST_SUITE_P(Shapes, SweepsOf,
                         ::testing::Values(Shape::cubes, Shape::rods, Shape::coincident, Shape::lattice));

TEST(SweepChooser, TakesTheAxisThatSeparatesBest) {
    std::vector<Entry> plates(3'000);  // thin only on y
    for (std::size_t i = 0; i < plates.size(); ++i) {
        plates[i] = {{0, float(i), 0}, {1, float(i) + 0.5f, 1}, std::uint32_t(i), 0};
    }
    const GivenSource source(plates, 0);
    const std::vector<EntryId> ids = ids_of(plates);
    const EntryList all(source, ids);
    const SweepChoice choice = SweepChooser({}).choose({all, all, true});
    EXPECT_EQ(choice.axis, 1u);
    EXPECT_TRUE(choice.good);
}

TEST(PartByShape, PartsBoxesByTheAxesOnWhichTheyAreLong) {
    const std::vector<Entry> rods = make_entries(Shape::rods, 90, 1);
    const GivenSource source(rods, 0);
    const std::vector<EntryId> ids = ids_of(rods);
    const auto parts = part_by_shape({source, ids}, {});
    std::size_t all = 0;
    for (unsigned axes = 0; axes < 8; ++axes) {
        all += parts[axes].size();
        for (const std::uint32_t position : parts[axes]) EXPECT_EQ(axes, 1u << position % 3);
    }
    EXPECT_EQ(all, rods.size());
}

}  // namespace
}  // namespace octopair::test
