// Tests the kernel that encodes many boxes at once against its specification and against for_each_octant_of().
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <vector>

#include "octree/build/encoder.hpp"
#include "octree/build/linear_octree.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

struct Encoding : ::testing::TestWithParam<std::string> {
    Encoding() : boxes(make_boxes(GetParam(), 20'000, 3)), objects{boxes} {
        layout = make_layout(BoxSource(objects, nullptr, 0), {});
        encoder.emplace(layout.space, layout.directory, no_list);
    }

    static constexpr std::uint32_t no_list = 1u << 30;
    std::vector<Box3f> boxes;
    Objects objects;
    OctreeLayout layout;
    std::optional<BatchEncoder> encoder;
};

void expect_same(const EncodedBatch& found, const EncodedBatch& expected, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(found.lists[i], expected.lists[i]);
        ASSERT_EQ(found.homes[i].object, expected.homes[i].object);
        ASSERT_EQ(found.homes[i].ends, expected.homes[i].ends);
    }
    ASSERT_EQ(found.crossers, expected.crossers);
    for (std::size_t i = 0; i < found.crossers; ++i) {
        ASSERT_EQ(found.crosser[i], expected.crosser[i]);
        ASSERT_EQ(found.leaf[i], expected.leaf[i]);
        for (unsigned axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(found.low[axis][i], expected.low[axis][i]);
            ASSERT_EQ(found.high[axis][i], expected.high[axis][i]);
        }
    }
}

TEST_P(Encoding, KernelAndSpecificationAgree) {
    std::mt19937 random(1);
    std::vector<Entry> entries(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        std::copy_n(boxes[i].min, 3, entries[i].min);
        std::copy_n(boxes[i].max, 3, entries[i].max);
        entries[i].object = std::uint32_t(random());
        entries[i].mask = std::uint32_t(random() & random() & 63);
    }
    EncodedBatch found, expected;
    for (std::size_t begin = 0; begin < boxes.size();) {
        const std::size_t count = std::min<std::size_t>(1 + random() % max_encoded, boxes.size() - begin);
        const auto some = std::span<const Box3f>(boxes).subspan(begin, count);
        ASSERT_TRUE(encoder->encode({some, std::uint32_t(begin)}, found));
        ASSERT_TRUE(encoder->encode_scalar({some, std::uint32_t(begin)}, expected));
        expect_same(found, expected, count);
        const auto some_entries = std::span<const Entry>(entries).subspan(begin, count);
        encoder->encode(some_entries, found);
        encoder->encode_scalar(some_entries, expected);
        expect_same(found, expected, count);
        begin += count;
    }
}

void expect_same(const LocatedBatch& found, const LocatedBatch& expected, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(found.leaves[i], expected.leaves[i]);
    ASSERT_EQ(found.crossers, expected.crossers);
    for (std::size_t i = 0; i < found.crossers; ++i) {
        ASSERT_EQ(found.crosser[i], expected.crosser[i]);
        ASSERT_EQ(found.leaf[i], expected.leaf[i]);
        ASSERT_EQ(found.end_leaf[i], expected.end_leaf[i]);
        ASSERT_EQ(found.cells(i).lo, expected.cells(i).lo);
        ASSERT_EQ(found.cells(i).hi, expected.cells(i).hi);
    }
}

TEST_P(Encoding, LocatorAndSpecificationAgree) {
    std::mt19937 random(3);
    LocatedBatch found, expected;
    for (std::size_t begin = 0; begin < boxes.size();) {
        const std::size_t count = std::min<std::size_t>(1 + random() % max_encoded, boxes.size() - begin);
        const auto some = std::span<const Box3f>(boxes).subspan(begin, count);
        ASSERT_TRUE(encoder->locator.locate(some, found));
        ASSERT_TRUE(encoder->locator.locate_scalar(some, expected));
        expect_same(found, expected, count);
        BatchEntries entries;
        ASSERT_TRUE(make_entries({some}, entries));
        encoder->locator.locate(std::span<const Entry>(entries).first(count), found);
        expect_same(found, expected, count);
        begin += count;
    }
}

TEST_P(Encoding, TakesTheNumbersOfObjects) {
    std::mt19937 random(4);
    std::vector<std::uint32_t> numbers(boxes.size());
    for (std::uint32_t& object : numbers) object = std::uint32_t(random());
    EncodedBatch found, expected;
    for (const std::size_t count : {std::size_t(1), std::size_t(7), std::size_t(100), max_encoded}) {
        const Float32Boxes plain{std::span<const Box3f>(boxes).first(count), 0, numbers.data()};
        ASSERT_TRUE(encoder->encode(plain, found));
        ASSERT_TRUE(encoder->encode_scalar(plain, expected));
        expect_same(found, expected, count);
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(found.homes[i].object, numbers[i]);
    }
}

/// Ghosts of one box, by octant.
using Ghosts = std::map<OctantIndex, CellEntry>;

TEST_P(Encoding, GhostsAreThoseOfTheRule) {
    std::mt19937 random(2);
    EncodedBatch batch;
    GhostGroup group;
    std::size_t left_out = 0, made = 0;
    for (std::size_t begin = 0; begin < boxes.size(); begin += max_encoded) {
        const std::size_t count = std::min(max_encoded, boxes.size() - begin);
        std::vector<Entry> entries(count);
        for (std::size_t i = 0; i < count; ++i) {
            std::copy_n(boxes[begin + i].min, 3, entries[i].min);
            std::copy_n(boxes[begin + i].max, 3, entries[i].max);
            entries[i].object = std::uint32_t(begin + i);
            entries[i].mask = std::uint32_t(random() & 56);  // sets, and class bits that a nested octree brings
        }
        encoder->encode(entries, batch);
        for (std::size_t first = 0; first < batch.crossers; first += GhostGroup::most) {
            const std::size_t in_group = std::min(GhostGroup::most, batch.crossers - first);
            encoder->ghosts(batch, {first, in_group}, group);
            for (std::size_t k = 0; k < in_group; ++k) {
                if ((group.left_out >> k & 1u) != 0) {
                    ++left_out;
                    continue;
                }
                const Entry& entry = entries[batch.crosser[first + k]];
                const Directory::Leaf home(batch.leaf[first + k]);
                Ghosts found, expected;
                ASSERT_LT(group.counts[k], GhostGroup::slots);
                for (std::size_t i = 0; i < group.counts[k]; ++i) {
                    const std::size_t at = GhostGroup::slots * k + i;
                    ASSERT_TRUE(found.emplace(group.octants[at], group.entries[at]).second);
                }
                for_each_octant_of(
                    layout.space.cells(entry), layout.directory, home, [&](OctantIndex octant, unsigned begins) {
                        if (octant == home.octant()) return;
                        Entry ghost = entry;
                        ghost.mask |= begins;
                        expected.emplace(octant,
                                         OctantCells(layout.space, layout.directory.octants()[octant]).entry(ghost));
                    });
                ASSERT_EQ(found.size(), expected.size());
                for (const auto& [octant, ghost] : expected) {
                    ASSERT_EQ(found[octant].ends, ghost.ends);
                    ASSERT_EQ(found[octant].object, ghost.object);
                    ++made;
                }
            }
        }
    }
    RecordProperty("ghosts", std::to_string(made) + ", boxes left to the rule: " + std::to_string(left_out));
}

TEST_P(Encoding, InvalidBoxesAreFound) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    EncodedBatch batch;
    for (const std::size_t count : {1u, 3u, 8u, 100u}) {
        for (const std::size_t bad : {std::size_t(0), count / 2, count - 1}) {
            std::vector<Box3f> some(boxes.begin(), boxes.begin() + std::ptrdiff_t(count));
            ASSERT_TRUE(encoder->encode({some}, batch));
            for (unsigned axis = 0; axis < 3; ++axis) {
                for (const float value : {nan, infinity, -infinity}) {
                    std::vector<Box3f> broken = some;
                    broken[bad].min[axis] = value;
                    ASSERT_FALSE(encoder->encode({broken}, batch));
                    broken = some;
                    broken[bad].max[axis] = value;
                    ASSERT_FALSE(encoder->encode({broken}, batch));
                }
                std::vector<Box3f> broken = some;
                std::swap(broken[bad].min[axis], broken[bad].max[axis]);
                if (broken[bad].min[axis] != broken[bad].max[axis]) {
                    ASSERT_FALSE(encoder->encode({broken}, batch));
                }
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Encoding, ::testing::ValuesIn(all_kind_names()), param_name);

}  // namespace
}  // namespace octopair::test
