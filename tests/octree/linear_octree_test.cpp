// Tests the invariants of the linear octree on every kind of scene:
// - The octants tile the space of the tree.
// - Each box has an entry in every required octant, at most eight in total.
// - The octree is the same for any distribution of the work.

#include "octree/linear_octree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <random>

#include "samples/scenes.hpp"

namespace octopair::test {
namespace {

/// Simulates many threads, and runs the shares in reverse order.
class BackwardExecutor final : public Executor {
public:
    explicit BackwardExecutor(unsigned width) : width_(width) {}
    unsigned width() const override { return width_; }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
        for (std::size_t i = count; i-- > 0;) body(i);
    }
    void for_each_writing(std::size_t, const std::function<void(std::size_t, ShareWriter&)>&) override {}

private:
    unsigned width_;
};

constexpr std::size_t scene_size = 30000;

class Scene : public ::testing::TestWithParam<std::string> {
protected:
    Scene()
        : boxes_(samples::make_scene(GetParam(), scene_size, 7)),
          objects_{std::span<const Box3f>(boxes_), {}},
          source_(objects_, nullptr, 0) {
        NoPairs none;
        SerialExecutor serial(none);
        octree_.build(source_, serial, {});
    }

    std::vector<Box3f> boxes_;
    Objects objects_;
    BoxSource source_;
    LinearOctree octree_;
};

TEST_P(Scene, DirectoryIsAPreOrderWhoseLeavesTileTheSpace) {
    const auto octants = octree_.octants();
    ASSERT_EQ(octants[0].next, octants.size());
    long double volume = 0;
    for (OctantIndex i = 0; i < octants.size(); ++i) {
        if (i > 0) {
            ASSERT_LT(octants[i - 1].code(), octants[i].code());
        }
        if (octants[i].leaf()) {
            ASSERT_EQ(octants[i].next, i + 1);
            const long double side = 1.0L / (1u << octants[i].level);
            volume += side * side * side;
            continue;
        }
        for (unsigned digit = 0; digit < 8; ++digit) {
            const OctantIndex child = octree_.directory().child(octants[i], digit);
            ASSERT_EQ(octants[child].code(), octants[i].code().child(digit));
            ASSERT_EQ(octants[child].parent, i);
        }
    }
    EXPECT_EQ(volume, 1.0L);
}

TEST_P(Scene, EveryBoxHasOneToEightEntriesWhichCoverIt) {
    std::map<std::uint32_t, std::vector<OctantIndex>> octants_of;
    for (OctantIndex octant = 0; octant < octree_.octants().size(); ++octant) {
        for (const Entry& entry : octree_.entries(octant)) {
            ASSERT_TRUE(octree_.octants()[octant].touches(octree_.space().cells(entry)));
            octants_of[entry.object].push_back(octant);
        }
    }
    ASSERT_EQ(octants_of.size(), boxes_.size());
    for (const auto& [object, octants] : octants_of) {
        ASSERT_LE(octants.size(), 8u);
        Entry entry;
        ASSERT_TRUE(source_.load(object, {&entry, 1}));
        const CellBox cells = octree_.space().cells(entry);
        for (unsigned corner = 0; corner < 8; ++corner) {
            Cell cell = cells.lo;
            for (unsigned axis = 0; axis < 3; ++axis) {
                if (corner >> axis & 1u) cell[axis] = cells.hi[axis];
            }
            const OctalCode at = OctalCode::from_cell({cell[0], cell[1], cell[2]}, deepest);
            std::size_t covering = 0;
            for (const OctantIndex octant : octants) covering += octree_.octants()[octant].code().contains(at) ? 1 : 0;
            ASSERT_EQ(covering, 1u) << "object " << object << " corner " << corner;
        }
    }
}

TEST_P(Scene, ClassBitsSayOnWhichAxesABoxBeginsBeforeItsOctant) {
    for (OctantIndex octant = 0; octant < octree_.octants().size(); ++octant) {
        const Cell& first = octree_.octants()[octant].lo;
        for (const Entry& entry : octree_.entries(octant)) {
            const CellBox cells = octree_.space().cells(entry);
            for (unsigned axis = 0; axis < 3; ++axis) {
                ASSERT_EQ(entry.mask >> axis & 1u, unsigned(cells.lo[axis] < first[axis]));
            }
        }
    }
}

TEST_P(Scene, SharingOutTheWorkChangesNothing) {
    for (const unsigned width : {2u, 3u, 16u}) {
        BackwardExecutor executor(width);
        LinearOctree other;
        other.build(source_, executor, {});
        ASSERT_EQ(other.octants().size(), octree_.octants().size());
        for (OctantIndex octant = 0; octant < octree_.octants().size(); ++octant) {
            const auto ours = octree_.entries(octant);
            const auto theirs = other.entries(octant);
            ASSERT_EQ(ours.size(), theirs.size());
            for (std::size_t i = 0; i < ours.size(); ++i) {
                ASSERT_EQ(ours[i].object, theirs[i].object);
                ASSERT_EQ(ours[i].mask, theirs[i].mask);
            }
        }
    }
}

std::vector<std::string> kinds() {
    std::vector<std::string> names;
    for (const std::string_view kind : samples::scene_kinds()) names.emplace_back(kind);
    return names;
}

/// The sorted entries of some objects, and the positions where the entries of each octant begin.
struct OwnedList {
    std::vector<Entry> entries;
    std::vector<std::uint64_t> home_begins, ghost_begins;
};

/// Returns the list of a block of objects, made by the steps of a worker in the paper's arrangement.
OwnedList sorted_list(const EntrySource& source, const OctreeLayout& layout, ObjectBlock objects) {
    BuildMemory memory(own_pages(), own_pages());
    memory.resize(source.size(), 1, layout.directory.octants().size(), 1);
    const std::stop_token stop;
    const BuildSteps steps{source, layout.space, layout.directory, memory, stop};
    const std::array<std::size_t, 1> alone = {0};
    const std::array<NumberedOctants, 1> octants = {NumberedOctants{0, 0, OctantIndex(memory.octants)}};
    steps.encode({0, objects});
    steps.count(octants[0], alone);
    OwnedList list;
    list.entries.resize(std::size_t(memory.totals[0]) + 1);
    const std::array<std::uint64_t, 1> begin = {0};
    // Runs the step twice: a repeated step must give the same result.
    for (int i = 0; i < 2; ++i) steps.scatter({0, objects}, {list.entries, begin, octants, list.entries.size() - 1});
    list.entries.pop_back();
    const auto homes = memory.home_part(memory.places, 0), ghosts = memory.ghost_part(memory.places, 0);
    list.home_begins.assign(homes.begin(), homes.end());
    list.ghost_begins.assign(ghosts.begin(), ghosts.end());
    return list;
}

/// Merges the lists of a machine, like the first rank of the machine.
OwnedList merged_list(std::span<const SortedList> lists) {
    OwnedList merged;
    std::size_t entries = 0;
    for (const SortedList& list : lists) entries += list.entries.size();
    merged.entries.resize(entries);
    merged.home_begins.resize(lists[0].home_begins.size());
    merged.ghost_begins.resize(lists[0].home_begins.size());
    EXPECT_EQ(merge_lists(lists, {merged.entries, merged.home_begins, merged.ghost_begins}, {}), entries);
    return merged;
}

TEST_P(Scene, MergedListsAreTheSameOctree) {
    for (const std::size_t count : {1, 2, 5}) {
        const OctreeLayout layout = make_layout(source_, {});
        std::vector<OwnedList> owned;
        std::vector<SortedList> lists;
        lists.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            const ObjectBlock objects{boxes_.size() * i / count, boxes_.size() * (i + 1) / count};
            owned.push_back(sorted_list(source_, layout, objects));
        }
        for (const OwnedList& list : owned) lists.push_back({list.entries, list.home_begins, list.ghost_begins});
        OwnedList last_two;
        if (count == 5) {
            last_two = merged_list(std::span(lists).last(2));
            lists.resize(3);
            lists.push_back({last_two.entries, last_two.home_begins, last_two.ghost_begins});
        }
        LinearOctree merged;
        merged.assemble(layout, lists, {});
        ASSERT_EQ(merged.entry_count(), octree_.entry_count());
        for (OctantIndex octant = 0; octant < octree_.octants().size(); ++octant) {
            const auto expected = octree_.entries(octant), found = merged.entries(octant);
            ASSERT_EQ(found.size(), expected.size());
            ASSERT_EQ(std::memcmp(found.data(), expected.data(), expected.size_bytes()), 0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Scene, ::testing::ValuesIn(kinds()), [](const auto& instance) {
    std::string name = instance.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST(OctantSample, HasMoreOfMoreObjects) {
    EXPECT_EQ(octant_sample(1'000'000).stride(), 64u);
    EXPECT_EQ(octant_sample(1'000'000'000).stride(), 476u);  // at most 2^21 objects are sampled
    const Sample large = octant_sample(10'000'000'000);
    EXPECT_LE(large.stride(), 2048u);  // more than 2^21 objects, so that a sampled object never represents a crowd
    EXPECT_LT(large[large.size() - 1], 10'000'000'000u);
    EXPECT_LT(large[large.size() - 2], large[large.size() - 1]);
}

}  // namespace
}  // namespace octopair::test
