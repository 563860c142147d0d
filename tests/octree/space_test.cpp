// Tests Space: the map from coordinates to cells, and its kernel.
#include "octree/plan/space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace octopair::test {
namespace {

TEST(Space, CellsNeverFallAsTheCoordinateGrows) {
    std::vector<Entry> sample(100);
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const float at = 1e7f + float(i);
        sample[i] = {{at, at * 1e-20f, -at}, {at + 2, at * 1e-20f, 1 - at}, std::uint32_t(i), 0};
    }
    const Space space = Space::fit(sample, 100);
    const float values[] = {-3.4e38f, -1e30f, -1e7f,   -1,   -0.0f,      0.0f,  1e-45f,
                            1e-13f,   1,      9999999, 1e7f, 1.00001e7f, 1e30f, 3.4e38f};
    for (unsigned axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 1; i < std::size(values); ++i) {
            EXPECT_LE(space.map().cell(values[i - 1], axis), space.map().cell(values[i], axis));
        }
        EXPECT_LT(space.map().cell(3.4e38f, axis), cells_per_axis);
    }
}

TEST(Space, TheKernelFollowsTheMap) {
    std::mt19937 random(7);
    const std::vector<float> special = {0.0f, -0.0f, 1e-45f, -1e-45f, 3.4e38f, -3.4e38f, 0.5f, 1.0f};
    std::vector<Entry> entries(1001);
    for (Entry& entry : entries) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            std::array<float, 2> ends;
            for (float& end : ends) end = random() % 4 == 0 ? special[random() % 8] : float(random() % 1000) / 300 - 1;
            entry.min[axis] = std::min(ends[0], ends[1]);
            entry.max[axis] = std::max(ends[0], ends[1]);
        }
        entry.object = std::uint32_t(random());
        entry.mask = 0;
    }
    const Space space = Space::fit(std::span(entries).first(50), 1000);
    std::vector<Box3f> plain(entries.size());
    for (std::size_t i = 0; i < plain.size(); ++i) std::memcpy(&plain[i], &entries[i], sizeof(Box3f));
    std::vector<CellBox> boxes(entries.size()), plain_boxes(entries.size());
    space.cells(entries, boxes);
    space.cells(plain, plain_boxes);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(boxes[i].lo[axis], space.map().cell(entries[i].min[axis], axis));
            ASSERT_EQ(boxes[i].hi[axis], space.map().cell(entries[i].max[axis], axis));
        }
        ASSERT_EQ(plain_boxes[i].lo, boxes[i].lo);
        ASSERT_EQ(plain_boxes[i].hi, boxes[i].hi);
    }
}

TEST(Space, InvalidBoxesHaveOrderedCells) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const std::array<float, 5> numbers = {nan, -infinity, infinity, 0.2f, 0.7f};
    const Space space = Space::fit(std::vector<Entry>{{{0, 0, 0}, {1, 1, 1}, 0, 0}}, 100);
    for (const float low : numbers) {
        for (const float high : numbers) {
            const Box3f box{{low, low, low}, {high, high, high}};
            CellBox cells;
            space.cells(std::span(&box, 1), {&cells, 1});
            for (unsigned axis = 0; axis < 3; ++axis) {
                EXPECT_LE(cells.lo[axis], cells.hi[axis]);
                EXPECT_LE(cells.hi[axis], space.last_cell(axis));
            }
        }
    }
}

TEST(Space, AFarOutBoxDoesNotStretchIt) {
    std::vector<Entry> sample(1000);
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const float at = float(i) / 1000;
        sample[i] = {{at, at, at}, {at, at, at}, std::uint32_t(i), 0};
    }
    sample[500] = {{1e30f, 1e30f, 1e30f}, {1e30f, 1e30f, 1e30f}, 500, 0};
    const Space space = Space::fit(sample, 1000);
    EXPECT_NE(space.map().cell(0.25f, 1), space.map().cell(0.2501f, 1));
}

TEST(SpaceSample, MeasuresQuantilesAndExtremes) {
    std::mt19937 random(11);
    for (std::size_t size = 1; size < 300; size += size < 5 ? 1 : 37) {
        std::vector<SpaceSample::Interval> intervals(size);
        std::vector<double> lows, highs, extents;
        for (SpaceSample::Interval& interval : intervals) {
            interval.low = float(random() % 1000);
            interval.high = interval.low + float(random() % 50);
            lows.push_back(double(interval.low));
            highs.push_back(double(interval.high));
            extents.push_back(double(interval.high) - double(interval.low));
        }
        for (auto* values : {&lows, &highs, &extents}) std::ranges::sort(*values);
        const auto measured = [&](SpaceSample::Measure what) { return SpaceSample::measure(intervals, what); };
        EXPECT_EQ(measured(SpaceSample::Measure::low).quantile, lows[size / 64]);
        EXPECT_EQ(measured(SpaceSample::Measure::low).extreme, lows.front());
        EXPECT_EQ(measured(SpaceSample::Measure::high).quantile, highs[size - 1 - size / 64]);
        EXPECT_EQ(measured(SpaceSample::Measure::high).extreme, highs.back());
        EXPECT_EQ(measured(SpaceSample::Measure::extent).quantile, extents[size / 2]);
        EXPECT_EQ(measured(SpaceSample::Measure::extent).extreme, extents.back());
    }
}

}  // namespace
}  // namespace octopair::test
