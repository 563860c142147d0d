// Tests the invariants of the linear octree on every kind of scene:
// - The octants tile the space of the tree.
// - Each box has an entry in every required octant, at most eight in total.
// - The octree is the same for any distribution of the work.

#include "octree/build/linear_octree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "samples/scenes.hpp"

namespace octopair::test {
namespace {

/// Simulates many threads, and runs the shares in reverse order.
class BackwardExecutor final : public Executor {
public:
    explicit BackwardExecutor(unsigned width) : width_(width) {}
    unsigned width() const override { return width_; }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
        for (std::size_t i = count; i-- > 0;) {
            body(i);
            body(i);
        }
    }
    void for_each_writing(std::size_t, const std::function<void(std::size_t, ShareWriter&)>&) override {}

private:
    unsigned width_;
};

constexpr std::size_t scene_size = 30000;

bool same_entries(std::span<const CellEntry> a, std::span<const CellEntry> b) {
    return std::ranges::equal(
        a, b, [](const CellEntry& x, const CellEntry& y) { return x.ends == y.ends && x.object == y.object; });
}

class Scene : public ::testing::TestWithParam<std::string> {
protected:
    Scene()
        : boxes_(samples::make_scene(GetParam(), scene_size, 7)), objects_{boxes_, {}}, source_(objects_, nullptr, 0) {
        NoPairs none;
        SerialExecutor serial(none);
        octree_.build(source_, serial, {});
    }

    /// Returns the entry of an object, without class bits.
    Entry whole(std::uint32_t object) const {
        Entry entry;
        EXPECT_TRUE(source_.load(object, {&entry, 1}));
        return entry;
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
        for (const CellEntry& entry : octree_.entries(octant)) {
            ASSERT_TRUE(octree_.octants()[octant].touches(octree_.space().cells(whole(entry.object))));
            octants_of[entry.object].push_back(octant);
        }
    }
    ASSERT_EQ(octants_of.size(), boxes_.size());
    for (const auto& [object, octants] : octants_of) {
        ASSERT_LE(octants.size(), 8u);
        const CellBox cells = octree_.space().cells(whole(object));
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

TEST_P(Scene, EntriesHaveCellsOfTheirOctantAndClassBits) {
    for (OctantIndex octant = 0; octant < octree_.octants().size(); ++octant) {
        const Octant& place = octree_.octants()[octant];
        const OctantCells cells(octree_.space(), place);
        for (const CellEntry& entry : octree_.entries(octant)) {
            Entry expected = whole(entry.object);
            expected.mask = class_bits(octree_.space().cells(expected), place);
            ASSERT_EQ(entry.ends, cells.entry(expected).ends) << "object " << entry.object;
        }
    }
}

TEST_P(Scene, HomeEntriesAndGhostsAscend) {
    for (OctantIndex octant = 0; octant < octree_.octants().size(); ++octant) {
        const OctantCells cells(octree_.space(), octree_.octants()[octant]);
        std::size_t descents = 0;
        bool ghosts = false;
        const std::vector<CellEntry> entries = octree_.entries(octant);
        for (std::size_t i = 1; i < entries.size(); ++i) descents += entries[i - 1].object > entries[i].object ? 1 : 0;
        for (const CellEntry& entry : entries) {
            const CellBox box = octree_.space().cells(whole(entry.object));
            const bool large = natural_level(box) < octree_.directory().leaf(box.lo).level();
            const bool ghost = large || cells.mask_of(entry) != 0;
            ASSERT_LE(ghosts, ghost) << "a home entry follows a ghost";
            ghosts = ghost;
        }
        ASSERT_LE(descents, 1u);
    }
}

TEST_P(Scene, SharingOutTheWorkChangesNothing) {
    for (const unsigned width : {2u, 3u, 16u}) {
        BackwardExecutor executor(width);
        LinearOctree other;
        other.build(source_, executor, {});
        ASSERT_EQ(other.octants().size(), octree_.octants().size());
        for (OctantIndex octant = 0; octant < octree_.octants().size(); ++octant) {
            ASSERT_TRUE(same_entries(octree_.entries(octant), other.entries(octant)));
        }
    }
}

std::vector<std::string> kinds() {
    std::vector<std::string> names;
    for (const std::string_view kind : samples::scene_kinds()) names.emplace_back(kind);
    return names;
}

INSTANTIATE_TEST_SUITE_P(Kinds, Scene, ::testing::ValuesIn(kinds()), [](const auto& instance) {
    std::string name = instance.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST(OctantSample, HasMoreOfMoreObjects) {
    EXPECT_EQ(octant_sample(100).stride(), 6u);  // at least 16 objects, so that most boxes lie within the space
    EXPECT_EQ(octant_sample(5).stride(), 1u);
    EXPECT_EQ(octant_sample(1'000'000).stride(), 64u);
    EXPECT_EQ(octant_sample(1'000'000'000).stride(), 476u);  // at most 2^21 objects are sampled
    const Sample large = octant_sample(10'000'000'000);
    EXPECT_LE(large.stride(), 2048u);  // more than 2^21 objects, so that a sampled object never represents a crowd
    EXPECT_LT(large[large.size() - 1], 10'000'000'000u);
    EXPECT_LT(large[large.size() - 2], large[large.size() - 1]);
}

}  // namespace
}  // namespace octopair::test
