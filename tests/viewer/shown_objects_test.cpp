// ShownObjects: the choice and the order of the rows of the overview.
#include <gtest/gtest.h>

#include <set>

#include "viewer/scene/shown_objects.hpp"
#include "viewer/shown_frames.hpp"

namespace octopair::test {

namespace {

using viewer::ShownObjects;

std::vector<std::uint32_t> rows_of(const ShownObjects& shown) {
    return {shown.objects().begin(), shown.objects().end()};
}

/// Checks that rows and objects are inverse, and that no object has two rows.
void expect_consistent(const ShownObjects& shown, std::size_t objects) {
    std::set<std::uint32_t> seen;
    for (std::uint32_t row = 0; row < shown.size(); ++row) {
        const std::uint32_t object = shown.objects()[row];
        ASSERT_LT(object, objects);
        EXPECT_TRUE(seen.insert(object).second) << object;
        EXPECT_EQ(shown.row_of(object), row);
    }
    for (std::uint32_t object = 0; object < objects; ++object) {
        EXPECT_TRUE(seen.contains(object) || shown.row_of(object) == ShownObjects::none);
    }
    EXPECT_EQ(shown.row_of(std::uint32_t(objects)), ShownObjects::none);
}

TEST(ShownObjects, AllOfASmallScene) {
    Random random(1);
    for (const std::size_t count : {0u, 1u, 2u, 100u, 1000u}) {
        const auto frame = frame_of(random_boxes(random, count, 0.1));
        for (const std::size_t most : {count, count + 1, std::size_t(200'000)}) {
            const ShownObjects shown(frame, count, most);
            EXPECT_EQ(shown.size(), count);
            expect_consistent(shown, count);
        }
    }
}

TEST(ShownObjects, AtMostSoMany) {
    Random random(2);
    for (int i = 0; i < 200; ++i) {
        const std::size_t count = random() % 300, most = random() % 320;
        const ShownObjects shown(frame_of(random_boxes(random, count, 0.1)), count, most);
        EXPECT_EQ(shown.size(), std::min(count, most)) << count << ' ' << most;
        expect_consistent(shown, count);
    }
}

TEST(ShownObjects, ALargeSceneShowsTheLargestObjects) {
    Random random(3);
    auto boxes = random_boxes(random, 1000, 0.1);
    for (std::size_t i = 0; i < 20; ++i) boxes[37 * i].max[i % 3] = boxes[37 * i].min[i % 3] + 50 + double(i);
    const ShownObjects shown(frame_of(boxes), 1000, 100);
    for (std::uint32_t i = 0; i < 20; ++i) EXPECT_NE(shown.row_of(37 * i), ShownObjects::none) << i;
}

TEST(ShownObjects, TheOtherRowsAreEvenInSpace) {
    Random random(4);
    std::vector<Box3d> boxes(16'000);
    for (Box3d& box : boxes) {
        for (int i = 0; i < 3; ++i) {
            box.min[i] = random_number(random, 0, 1);
            box.max[i] = box.min[i] + 0.001;
        }
    }
    const ShownObjects shown(frame_of(std::vector<Box3d>(boxes.begin(), boxes.begin() + 1)), 1, 1);
    viewer::FrameData frame;
    frame.boxes = std::span<const Box3d>(boxes);
    const ShownObjects part(frame, boxes.size(), 1600);
    std::array<int, 8> in_cell = {};
    for (const std::uint32_t object : part.objects()) {
        const Box3d& box = boxes[object];
        ++in_cell[std::size_t((box.min[0] > 0.5 ? 1 : 0) + (box.min[1] > 0.5 ? 2 : 0) + (box.min[2] > 0.5 ? 4 : 0))];
    }
    for (const int count : in_cell) EXPECT_NEAR(count, 200, 60);
}

TEST(ShownObjects, DependsOnTheBoxesAlone) {
    Random random(5);
    const auto boxes = random_boxes(random, 3000, 0.1);
    const auto frame = frame_of(boxes), other = frame_of(boxes);
    EXPECT_EQ(rows_of(ShownObjects(frame, 3000, 500)), rows_of(ShownObjects(other, 3000, 500)));
}

TEST(ShownObjects, AdjacentRowsAreNearInSpace) {
    // On a grid of 16 x 16 x 16 small boxes, each eight adjacent rows are a cube of 2 x 2 x 2.
    std::vector<Box3d> boxes;
    for (int i = 0; i < 4096; ++i) {
        const double x = i % 16, y = i / 16 % 16, z = i / 256.0 - i / 16 % 16 / 16.0 - i % 16 / 256.0;
        boxes.push_back({{x, y, z}, {x + 0.1, y + 0.1, z + 0.1}});
    }
    Random random(6);
    std::shuffle(boxes.begin(), boxes.end(), random);
    viewer::FrameData frame;
    frame.boxes = std::span<const Box3d>(boxes);
    const ShownObjects shown(frame, boxes.size(), boxes.size());
    for (std::size_t row = 0; row < 4096; row += 8) {
        Box3d all = boxes[shown.objects()[row]];
        for (std::size_t i = 1; i < 8; ++i) all = viewer::joined(all, boxes[shown.objects()[row + i]]);
        for (int i = 0; i < 3; ++i) EXPECT_LT(all.max[i] - all.min[i], 1.5) << row;
    }
}

TEST(ShownObjects, AbsentObjectsHaveTheLastRows) {
    Random random(7);
    const auto boxes = random_boxes(random, 100, 0.1);
    std::vector<std::uint8_t> exists(100, 1);
    for (std::size_t i = 0; i < 100; i += 3) exists[i] = 0;
    const auto frame = frame_of(boxes, exists);
    const ShownObjects shown(frame, 100, 100);
    expect_consistent(shown, 100);
    EXPECT_EQ(shown.size(), 100u);
    for (std::size_t row = 0; row < 66; ++row) EXPECT_EQ(exists[shown.objects()[row]], 1) << row;
    const ShownObjects part(frame, 100, 40);
    expect_consistent(part, 100);
    EXPECT_EQ(part.size(), 40u);
    const ShownObjects none(frame_of(boxes, std::vector<std::uint8_t>(100, 0)), 100, 10);
    EXPECT_EQ(none.size(), 10u);
}

TEST(ShownObjects, DegenerateBounds) {
    for (const double size : {0.0, 1e-300, 1e300}) {
        const std::vector<Box3d> boxes(10, Box3d{{-size, -size, -size}, {size, size, size}});
        const ShownObjects shown(frame_of(boxes), 10, 4);
        EXPECT_EQ(shown.size(), 4u);
        expect_consistent(shown, 10);
    }
}

TEST(ShownObjects, FirstInOrder) {
    const ShownObjects first = ShownObjects::first(5);
    EXPECT_TRUE(first.in_order());
    EXPECT_EQ(rows_of(first), (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
    EXPECT_EQ(first.row_of(4), 4u);
    EXPECT_EQ(first.row_of(5), ShownObjects::none);
    EXPECT_TRUE(ShownObjects().in_order());
}

TEST(ShownObjects, InOrderOnlyIfAllAreShown) {
    std::vector<Box3d> boxes;
    for (int i = 0; i < 10; ++i) boxes.push_back({{double(i), 0, 0}, {i + 0.5, 1, 1}});
    EXPECT_TRUE(ShownObjects(frame_of(boxes), 10, 10).in_order());
    EXPECT_FALSE(ShownObjects(frame_of(boxes), 10, 9).in_order());
    std::reverse(boxes.begin(), boxes.end());
    EXPECT_FALSE(ShownObjects(frame_of(boxes), 10, 10).in_order());
}

TEST(ShownObjects, BoundsLeaveOutAbsentObjects) {
    const std::vector<Box3d> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{-9, -9, -9}, {9, 9, 9}}};
    const Box3d bounds = viewer::bounds_of(frame_of(boxes, {1, 0})).value();
    EXPECT_EQ(bounds.max[0], 1);
    EXPECT_EQ(bounds.min[0], 0);
    EXPECT_FALSE(viewer::bounds_of(frame_of(boxes, {0, 0})).has_value());
}

}  // namespace

}  // namespace octopair::test
