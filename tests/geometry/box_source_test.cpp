// Boxes on their way in: every fault is seen, wherever it stands, and rounding goes outward.
#include "geometry/box_source.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>
#include <vector>

#include "geometry/box_kernel.hpp"

namespace octopair {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST(BoxKernel, SeesEachFaultOfEachNumber) {
    const std::vector<Box3f> boxes(300, {{0, 1, 2}, {3, 1, 5}});
    std::vector<Entry> entries(boxes.size());
    ASSERT_TRUE(copy_boxes(boxes, entries));
    for (const std::size_t place : {std::size_t(0), std::size_t(7), boxes.size() - 1}) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            for (const float bad : {infinity, -infinity, nan, -nan, 100.0f}) {
                auto spoilt = boxes;
                spoilt[place].min[axis] = bad;
                EXPECT_FALSE(copy_boxes(spoilt, entries)) << bad;
                spoilt = boxes;
                spoilt[place].max[axis] = bad == 100.0f ? -bad : bad;
                EXPECT_FALSE(copy_boxes(spoilt, entries)) << bad;
            }
        }
    }
}

TEST(BoxKernel, AgreesWithItsSpecification) {
    const std::array<float, 10> values = {0, -0.0f, 1, -1, 1e-45f, FLT_MAX, -FLT_MAX, infinity, -infinity, nan};
    std::mt19937 random(1);
    std::array<std::size_t, 2> seen{};
    for (int i = 0; i < 20'000; ++i) {
        Box3f box{};
        for (unsigned axis = 0; axis < 3; ++axis) {
            box.min[axis] = values[random() % (i % 2 == 0 ? 7 : 10)];
            box.max[axis] = values[random() % (i % 2 == 0 ? 7 : 10)];
            if (i % 4 != 3 && box.min[axis] > box.max[axis]) std::swap(box.min[axis], box.max[axis]);
        }
        Entry entry;
        ASSERT_EQ(copy_boxes({&box, 1}, {&entry, 1}), is_box(box));
        ++seen[is_box(box) ? 1 : 0];
    }
    EXPECT_GT(seen[0], 1000u);
    EXPECT_GT(seen[1], 1000u);
}

TEST(BoxSource, EntriesHoldTheirBoxes) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-1, 1);
    for (const double scale : {1e-30, 1.0, 1e7, 1e30}) {
        std::vector<Box3d> boxes(500);
        for (Box3d& box : boxes) {
            for (unsigned axis = 0; axis < 3; ++axis) {
                box.min[axis] = (place(random) + 10) * scale;
                box.max[axis] = box.min[axis] + std::abs(place(random)) * scale * 1e-3;
            }
        }
        const Objects objects{boxes, {}};
        const BoxSource source(objects, nullptr, 0);
        std::vector<Entry> entries(boxes.size());
        ASSERT_TRUE(source.load(0, entries));
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for (std::size_t k = 0; k < boxes.size(); ++k) {
                const auto a = std::uint32_t(i), b = std::uint32_t(k);
                const bool counts = source.counts(a, b);
                ASSERT_TRUE(overlap(entries[i], entries[k]) || !counts);
                ASSERT_TRUE(counts || !certain(entries[i], entries[k], source.slack()));
            }
        }
    }
}

}  // namespace
}  // namespace octopair
