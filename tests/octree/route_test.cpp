// Tests the numbers of docs/route.md: what the steps of a search make of its three boxes.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "boxes/box_source.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/executor.hpp"
#include "octree/sweep/cell_sweep.hpp"

namespace octopair::test {
namespace {

std::string page() {
    std::ifstream file(OCTOPAIR_ROUTE_PAGE);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Route, ThreeBoxesBecomeOnePair) {
    const std::vector<Box3f> boxes = {
        {{0, 0, 0}, {1, 1, 1}}, {{0.5f, 0.5f, 0.5f}, {1.5f, 1.5f, 1.5f}}, {{4, 4, 4}, {5, 5, 5}}};
    const Objects objects{std::span<const Box3f>(boxes)};
    const BoxSource source(objects, nullptr, 0.0);
    EXPECT_EQ(octant_sample(3).size(), 3u);

    NoPairs none;
    SerialExecutor serial(none);
    LinearOctree octree;
    octree.build(source, serial, {});
    ASSERT_EQ(octree.octants().size(), 1u);
    const Space& space = octree.space();
    EXPECT_EQ(space.map().cell(0, 0), 0u);
    EXPECT_EQ(space.map().cell(5, 0), space.last_cell(0));

    const std::vector<CellEntry> entries = octree.entries(0);
    ASSERT_EQ(entries.size(), 3u);
    std::string cells;
    for (const CellEntry& entry : entries) {
        cells += (cells.empty() ? "" : ", ") + std::to_string(entry.low(0)) + " to " + std::to_string(entry.high(0));
    }
    EXPECT_NE(page().find("On the long axis: " + cells), std::string::npos) << cells;

    CellSet set;
    const std::span<const CellEntry> run = entries;
    set.assign({&run, 1});
    set.make_planes();
    const CellSweep sweep{set, set, SweepKind::self};
    std::vector<CellHit> hits(CellSweep::min_room + judged_room);
    CellCursor cursor;
    const std::size_t count = find_hits(sweep, cursor, std::span(hits).first(CellSweep::min_room));
    ASSERT_EQ(count, 1u);
    EXPECT_EQ(hits[0], CellHit(0 << 16 | 1));

    std::array<Pair, 1 + judged_room> pairs;
    std::array<std::uint32_t, 1 + judged_room> doubtful;
    JudgedHits judged{.pairs = pairs.data(), .doubtful = doubtful.data()};
    judge_hits(sweep, std::span(hits).first(1), certain_depths(OctantCells(space, octree.octants()[0]), source),
               judged);
    EXPECT_EQ(judged.doubtful_count, 0u);
    ASSERT_EQ(judged.pair_count, 1u);
    EXPECT_EQ(pairs[0], (Pair{0, 1}));
}

}  // namespace
}  // namespace octopair::test
